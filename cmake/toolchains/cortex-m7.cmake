# SPDX-License-Identifier: Apache-2.0
# A bare Cortex-M7 with single-precision floating point (Debian: gcc-arm-none-eabi, libnewlib-arm-none-eabi,
# libstdc++-arm-none-eabi-newlib).
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_FLAGS_INIT "-mthumb -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-sp-d16 -fno-exceptions -fno-rtti \
-fno-threadsafe-statics -ffunction-sections -fdata-sections -DEIGEN_NO_MALLOC")
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG" CACHE STRING "Flags of the release build")
# Eigen is headers only, so the host's copy serves; programs are looked for on the host.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
