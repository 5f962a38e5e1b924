# SPDX-License-Identifier: Apache-2.0
# How our own targets are compiled.

# Standard, default build type and compiler cache: settings that only the top-level project may choose.
macro(dfdyn_set_top_level_defaults)
    set(CMAKE_CXX_EXTENSIONS OFF)
    set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
    if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
        set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug or Release" FORCE)
    endif()
    find_program(DFDYN_CCACHE ccache)
    if(DFDYN_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
        set(CMAKE_CXX_COMPILER_LAUNCHER "${DFDYN_CCACHE}")
    endif()
endmacro()

# Warnings (errors in our own builds) and this machine's vectors, for a target of ours.
function(dfdyn_compile_strictly target)
    target_compile_options(${target} PRIVATE
        -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # clang's own version of this also warns of every intended widening, as of a float in a test of doubles.
        target_compile_options(${target} PRIVATE -Wdouble-promotion)
    endif()
    if(PROJECT_IS_TOP_LEVEL)
        target_compile_options(${target} PRIVATE -Werror)
    endif()
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
        # GCC 12 blames its own AVX-512 header wherever Eigen uses it (GCC bug 105593).
        target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized -Wno-uninitialized)
    endif()
    if(DFDYN_NATIVE)
        target_compile_options(${target} PUBLIC -march=native)
    endif()
endfunction()

# Every subfolder that has a CMakeLists.txt; the folders list their own sources.
macro(dfdyn_add_subfolders)
    file(GLOB dfdyn_subfolder_lists CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*/CMakeLists.txt")
    foreach(dfdyn_subfolder_list IN LISTS dfdyn_subfolder_lists)
        get_filename_component(dfdyn_subfolder "${dfdyn_subfolder_list}" DIRECTORY)
        add_subdirectory("${dfdyn_subfolder}")
    endforeach()
endmacro()
