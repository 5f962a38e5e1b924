// SPDX-License-Identifier: Apache-2.0
#pragma once

// Every entry header includes this one: it refuses compiler flags under which the library is wrong without a
// sign of it.
//
// With finite-math flags the compiler takes every number to be finite and removes the tests that keep NaN and
// infinity out of the state: one faulty sample is learned, and every prediction after it is NaN. With flags
// that reorder sums, the reduction of a cosine's argument by multiples of π/2 (W. J. Cody and W. Waite, 1980)
// loses its low parts: the features are then good to 2e-4 instead of 8e-8 at 8,000 rad.
#if (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(__FAST_MATH__)
#error                                                                                                       \
    "dfdyn does not work with -ffast-math, -Ofast or -ffinite-math-only: they remove the tests that keep NaN and infinity out of what is learned. Compile this file without these flags, or with -fno-fast-math after them"
#elif defined(__ASSOCIATIVE_MATH__)
#error                                                                                                       \
    "dfdyn does not work with -funsafe-math-optimizations or -fassociative-math: they reorder sums whose order keeps their precision. Compile this file without these flags, or with -fno-associative-math after them"
#endif
