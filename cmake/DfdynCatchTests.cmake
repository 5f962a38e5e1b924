# SPDX-License-Identifier: Apache-2.0
# Test programs with Catch2, version 2 or 3.
find_package(Catch2 QUIET)
if(NOT TARGET Catch2::Catch2WithMain)
    message(FATAL_ERROR "The tests need Catch2 with its main, which was not found. On Debian or Ubuntu: apt-get install catch2")
endif()
list(APPEND CMAKE_MODULE_PATH "${Catch2_DIR}")
include(Catch)

# A test program whose sources the subfolders add. Each test case is a ctest entry with the label `label`. With LONG, the test
# cases with the tag [.long] are entries too, with the label `long`. ctest starts those of the highest COST first.
function(dfdyn_add_catch_program target label)
    cmake_parse_arguments(PARSE_ARGV 2 arg "LONG" "COST" "")
    add_executable(${target})
    dfdyn_compile_strictly(${target})
    target_link_libraries(${target} PRIVATE dfdyn_test_support Catch2::Catch2WithMain)
    # An exception within a CHECK ends the test case. Without the handlers of each CHECK, tests compile in three quarters of the time.
    target_compile_definitions(${target} PRIVATE DFDYN_TEST_DATA_DIR="${PROJECT_SOURCE_DIR}/tests/data" CATCH_CONFIG_FAST_COMPILE)
    set(timeout_s 300)
    if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
        set(timeout_s 1500)
    endif()
    if(NOT arg_COST)
        set(arg_COST 1)
    endif()
    # As tools/main.cpp does: otherwise the page faults of freed and new matrices take half of a training's time.
    set(keep_freed_memory ENVIRONMENT GLIBC_TUNABLES=glibc.malloc.mmap_threshold=33554432:glibc.malloc.trim_threshold=1073741824)
    catch_discover_tests(${target} TEST_PREFIX "${label}/"
        PROPERTIES LABELS ${label} TIMEOUT ${timeout_s} COST ${arg_COST} ${keep_freed_memory})
    if(arg_LONG)
        catch_discover_tests(${target} TEST_SPEC "[.long]" TEST_PREFIX "${label}/"
            PROPERTIES LABELS long TIMEOUT 3600 ${keep_freed_memory})
    endif()
endfunction()
