// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

/// What a tick of the example gave, as plain numbers: the same on every machine but for rounding.
struct TickOutcome {
    std::array<double, 6> prediction; ///< A
    std::array<double, 6> standard_deviation;
    bool predicted;
    bool learned;
};

/// Runs the embedding example from its start. `after_tick`, where given, is called after each tick of the
/// estimator, so that the caller can measure and compare. Returns 0 when the outcome is as expected; prints
/// nothing, allocates nothing.
int run_example(void (*after_tick)(const TickOutcome&) = nullptr);

/// The same with the model in double precision (not part of an image whose core has none).
int run_example_in_double(void (*after_tick)(const TickOutcome&) = nullptr);
