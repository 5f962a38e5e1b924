// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "tools/bench/timing/keep.hpp"
#include "tools/bench/timing/regression_task.hpp"

namespace dfdyn::tools {

/// One tick of a learner of the firmware: predicts from `rows`, adds them with their targets, and learns. The
/// variance is part of the learning, as in the estimator.
template <class Learner, class Scalar, class... Rows>
void whole_tick(Learner& learner, const Scalar* targets, const Rows*... rows) {
    Scalar means[RegressionTask::outputs];
    learner.predict(rows..., means);
    keep(means);
    Budget budget = Budget::unlimited();
    learner.begin(rows..., targets);
    learner.advance(budget);
}

} // namespace dfdyn::tools
