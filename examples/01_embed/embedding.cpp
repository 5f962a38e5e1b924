// SPDX-License-Identifier: Apache-2.0
// Observes an arm with an embedded estimator: a model written by `dfdyn train --header`, one object, one call
// per tick. For control see joint_controller.hpp.
#include "embedding.hpp"

#include "ur5_model.hpp" // constants, in flash
#include "ur5_ticks.hpp"

namespace {

using Estimator = dfdyn::Estimator<ur5_model::Model>;

Estimator estimator(ur5_model::constants); // the whole state; no heap
/// Multiply-adds of learning per tick: a sample is learned in two or three ticks.
constexpr dfdyn::Budget budget{Estimator::cost().learn / 2};
static_assert(budget.affords(Estimator::cost().largest_step), "a smaller budget would never learn anything");

} // namespace

int run_example(void (*after_tick)(const TickOutcome&)) {
    estimator.reset();
    float error_square = 0;
    float output_square = 0;
    for (const Ur5Sample& recorded : ur5_samples) {
        const auto estimate = estimator.tick(read_sensors<Estimator::Sample>(recorded), budget);
        if (estimate.status.predicted()) { // for comparison; never feed it forward
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
