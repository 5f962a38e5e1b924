// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/timing/interleaved.hpp"

#include <cstdint>
#include <functional>

namespace dfdyn::tools {

/// Measures whether the time per tick grows with the running time of the learner. One learner (float, 2d =
/// 200, six outputs, forgetting) runs through ten periods of `ticks` ticks. In each, the arm is stationary
/// most of the time, with exactly constant columns. Its states after the first and the tenth period then
/// continue side by side with the same input.
struct EnduranceBench {
    static constexpr int columns = 200;
    static constexpr int stretches = 10;
    std::int64_t ticks = 0; ///< of one period
    TickTimes first_moving, last_moving;
    TickTimes first_standing, last_standing;
    std::int64_t denormals = 0; ///< among the numbers of the last state

    /// Relative change of the 90th percentile, which is a tick that bounds a variance. These ticks take
    /// longer. Their number depends on the motion and would determine the median.
    double change_moving() const { return last_moving.p90 / first_moving.p90 - 1; }
    double change_standing() const { return last_standing.p90 / first_standing.p90 - 1; }
};

EnduranceBench run_endurance_bench(std::int64_t ticks, const RepetitionOptions& options,
                                   MultiplyAddProbe& probe, const std::function<void(double)>& on_share_done);

} // namespace dfdyn::tools
