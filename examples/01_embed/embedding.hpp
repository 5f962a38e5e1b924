// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

/// Result of one tick of the example as plain numbers, identical on every machine except for rounding.
struct TickOutcome {
    std::array<double, 6> prediction; ///< A
    std::array<double, 6> standard_deviation;
    bool predicted;
    bool learned;
};

/// Runs the embedding example from its initial state. `after_tick`, if given, is called after each tick of
/// the estimator, so that the caller can measure and compare. Returns 0 if the result is as expected. Prints
/// nothing and allocates nothing.
int run_example(void (*after_tick)(const TickOutcome&) = nullptr);

/// Same, with the model in double precision. Not part of an image for a core without double precision.
int run_example_in_double(void (*after_tick)(const TickOutcome&) = nullptr);
