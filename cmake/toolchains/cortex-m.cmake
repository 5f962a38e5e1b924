# SPDX-License-Identifier: Apache-2.0
# A bare Cortex-M with floating point (Debian: gcc-arm-none-eabi, libnewlib-arm-none-eabi, libstdc++-arm-none-eabi-newlib).
# DFDYN_CORE says which: cortex-m7 (single precision in hardware), cortex-m7-double (double too), cortex-m4f, cortex-m55.
set(DFDYN_CORE cortex-m7 CACHE STRING "cortex-m7, cortex-m7-double, cortex-m4f or cortex-m55")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES DFDYN_CORE)

if(DFDYN_CORE STREQUAL "cortex-m7")
    set(dfdyn_core_flags "-mcpu=cortex-m7 -mfpu=fpv5-sp-d16")
elseif(DFDYN_CORE STREQUAL "cortex-m7-double")
    set(dfdyn_core_flags "-mcpu=cortex-m7 -mfpu=fpv5-d16")
elseif(DFDYN_CORE STREQUAL "cortex-m4f")
    set(dfdyn_core_flags "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16")
elseif(DFDYN_CORE STREQUAL "cortex-m55")
    set(dfdyn_core_flags "-mcpu=cortex-m55+nomve")
else()
    message(FATAL_ERROR "DFDYN_CORE is '${DFDYN_CORE}'; expected cortex-m7, cortex-m7-double, cortex-m4f or cortex-m55")
endif()

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR ${DFDYN_CORE})
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_FLAGS_INIT "-mthumb ${dfdyn_core_flags} -mfloat-abi=hard -fno-exceptions -fno-rtti \
-fno-threadsafe-statics -fno-unwind-tables -fno-asynchronous-unwind-tables -ffunction-sections -fdata-sections")
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG" CACHE STRING "Flags of the release build")
# Packages of headers serve as installed for the host; programs are looked for on the host.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
