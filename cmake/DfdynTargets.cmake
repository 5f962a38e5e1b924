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
        # clang's own version also warns of every intended widening, for example of a float in a test of doubles.
        target_compile_options(${target} PRIVATE -Wdouble-promotion)
    endif()
    if(PROJECT_IS_TOP_LEVEL)
        target_compile_options(${target} PRIVATE -Werror)
    endif()
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
        # GCC 12 blames its own AVX-512 header wherever Eigen uses it (GCC bug 105593). Its warnings about bounds depend on
        # inlining, and most are wrong, also in std::string (GCC bug 105329).
        target_compile_options(${target} PRIVATE
            -Wno-maybe-uninitialized -Wno-uninitialized -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread)
    endif()
    # Not for users of an installed library: they may run on another machine.
    if(DFDYN_NATIVE)
        target_compile_options(${target} PUBLIC $<BUILD_INTERFACE:-march=native>)
    elseif(DFDYN_MARCH)
        target_compile_options(${target} PUBLIC "$<BUILD_INTERFACE:-march=${DFDYN_MARCH}>")
    endif()
endfunction()

# dfdyn_compile_by_folder(TARGET [HEADER...]): with DFDYN_COMPILE_BY_FOLDER, compiles all sources of a target in one folder of the
# caller, with its subfolders, as one file. The headers, which most of them include, are precompiled. Call it after all sources have
# been added. The grouping depends on the folder only, so that names clash in every build or in none.
function(dfdyn_compile_by_folder target)
    if(NOT DFDYN_COMPILE_BY_FOLDER)
        return()
    endif()
    get_target_property(sources ${target} SOURCES)
    foreach(source IN LISTS sources)
        get_filename_component(folder "${source}" ABSOLUTE)
        get_filename_component(folder "${folder}" DIRECTORY)
        file(RELATIVE_PATH folder "${CMAKE_CURRENT_SOURCE_DIR}" "${folder}")
        string(REGEX REPLACE "^([^/]+)/.*" "\\1" folder "${folder}")
        string(MAKE_C_IDENTIFIER "${target}_${folder}" group)
        set_source_files_properties("${source}" TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${group})
    endforeach()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    target_precompile_headers(${target} PRIVATE ${ARGN})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # Collects garbage from a gigabyte on, not from every few megabytes: a twentieth of the time, for half a gigabyte.
        target_compile_options(${target} PRIVATE --param=ggc-min-heapsize=1048576)
    endif()
    if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
        # A file-local name of another file in the folder cannot be confused with this one.
        target_compile_options(${target} PRIVATE -Wno-shadow)
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
