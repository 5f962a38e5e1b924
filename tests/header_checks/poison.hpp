// SPDX-License-Identifier: Apache-2.0
// What firmware headers may include, and then the names that they may not use. check_text.sh reads the list
// of what may be included from here.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#undef alloca
#undef assert
#undef errno

// The heap.
#pragma GCC poison malloc calloc realloc free aligned_alloc posix_memalign memalign alloca strdup
#pragma GCC poison unique_ptr shared_ptr weak_ptr make_unique make_shared allocator pmr
// Input and output.
#pragma GCC poison printf fprintf sprintf snprintf vprintf puts putchar fopen cout cerr clog cin endl
#pragma GCC poison ostream istream stringstream ostringstream to_string
// The way out.
#pragma GCC poison abort exit _exit terminate quick_exit setjmp longjmp assert raise
// Hidden state, threads and clocks.
#pragma GCC poison errno rand srand random_device mt19937 thread_local
#pragma GCC poison mutex lock_guard condition_variable jthread this_thread async
#pragma GCC poison chrono steady_clock system_clock clock_gettime gettimeofday nanosleep usleep
// Calls through types that allocate.
#pragma GCC poison unordered_map unordered_set
