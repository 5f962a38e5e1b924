// SPDX-License-Identifier: Apache-2.0
#pragma once

// Rejects compilers that cannot compile the library, and flags under which it would silently be wrong. Every
// entry header includes this file.
#if !defined(__clang__) && (!defined(__GNUC__) || __GNUC__ < 12)
#error                                                                                                       \
    "dfdyn needs g++ 12 or later, or clang (tested: 14): it uses their vector types and __builtin_shufflevector"
#elif __cplusplus < 202002L
#error "dfdyn needs C++20: compile with -std=c++20 or -std=gnu++20"
#endif

// With finite-math flags the compiler assumes that every number is finite and removes the tests that keep NaN
// and infinity out of the state: one faulty sample is learned, and every later prediction is NaN. With flags
// that reorder sums, the reduction of a cosine's argument by multiples of π/2 (W. J. Cody and W. Waite, 1980)
// loses its low parts: the features then have an error of 2e-4 instead of 8e-8 at 8,000 rad.
#if (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(__FAST_MATH__)
#error                                                                                                       \
    "dfdyn does not work with -ffast-math, -Ofast or -ffinite-math-only: they remove the tests that keep NaN and infinity out of what is learned. Compile this file without these flags, or with -fno-fast-math after them"
#elif defined(__ASSOCIATIVE_MATH__)
#error                                                                                                       \
    "dfdyn does not work with -funsafe-math-optimizations or -fassociative-math: they reorder sums whose order keeps their precision. Compile this file without these flags, or with -fno-associative-math after them"
#endif
