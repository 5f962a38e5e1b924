// SPDX-License-Identifier: Apache-2.0
// What it takes to embed the estimator: a model that `dfdyn train --header` wrote, one object, one call per
// tick.
#include "embedding.hpp"

#include "ur5_model.hpp"   // constants, in flash
#include "ur5_samples.hpp" // a stretch of a recording in place of the sensors

#include <algorithm>

namespace {

using Estimator = dfdyn::Estimator<ur5_model::Model>;

Estimator estimator(ur5_model::constants); // all of its state; no heap
constexpr dfdyn::Budget budget{Estimator::cost().learn /
                               2}; // of one tick: a sample is learned over two or three
static_assert(budget.affords(Estimator::cost().largest_step), "a smaller budget would never learn anything");

Estimator::Sample read_sensors(const Ur5Sample& recorded) {
    Estimator::Sample sample{
        .time_ns = 1000 * recorded.time_us, .position = {}, .output = {}, .output_valid = true};
    std::ranges::copy(recorded.position_rad, sample.position.begin());
    std::ranges::copy(recorded.current_A, sample.output.begin());
    return sample;
}

TickOutcome outcome_of(const Estimator::Estimate& estimate) {
    TickOutcome outcome{.prediction = {},
                        .standard_deviation = {},
                        .predicted = estimate.status.predicted(),
                        .learned = estimate.status.learned()};
    std::ranges::copy(estimate.prediction, outcome.prediction.begin());
    std::ranges::copy(estimate.standard_deviation, outcome.standard_deviation.begin());
    return outcome;
}

} // namespace

int run_example(void (*after_tick)(const TickOutcome&)) {
    estimator.reset();
    float error_square = 0;
    float output_square = 0;
    for (const Ur5Sample& recorded : ur5_samples) {
        const auto estimate = estimator.tick(read_sensors(recorded), budget);
        if (estimate.status.predicted()) { // in a robot: feed estimate.prediction forward
            error_square += estimate.innovation[1] * estimate.innovation[1];
            output_square += recorded.current_A[1] * recorded.current_A[1];
        }
        if (after_tick != nullptr) {
            after_tick(outcome_of(estimate));
        }
    }
    const bool learned = estimator.counters().learned > 50;
    return learned && error_square < 0.05F * output_square ? 0 : 1;
}
