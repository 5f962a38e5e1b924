// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "embedding.hpp"

#include "ur5_samples.hpp" // part of a recording instead of sensors

#include <algorithm>

/// Returns a recorded sample as if read from sensors: positions in rad, motor currents in A as the outputs.
template <class Sample>
Sample read_sensors(const Ur5Sample& recorded) {
    Sample sample{.time_ns = 1000 * recorded.time_us, .position = {}, .output = {}, .output_valid = true};
    std::ranges::copy(recorded.position_rad, sample.position.begin());
    std::ranges::copy(recorded.current_A, sample.output.begin());
    return sample;
}

template <class Estimate>
TickOutcome outcome_of(const Estimate& estimate) {
    TickOutcome outcome{.prediction = {},
                        .standard_deviation = {},
                        .predicted = estimate.status.predicted(),
                        .learned = estimate.status.learned()};
    std::ranges::copy(estimate.prediction, outcome.prediction.begin());
    std::ranges::copy(estimate.standard_deviation, outcome.standard_deviation.begin());
    return outcome;
}
