// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/timing/interleaved.hpp"

#include <cstdint>
#include <functional>

namespace dfdyn::tools {

/// Whether a tick takes longer the longer the learner has run. One learner (float, 2d = 200, six outputs,
/// forgetting) lives through ten stretches of `ticks` ticks, in each of which the arm stands still most of
/// the time, with exactly constant columns; its state after the first and after the tenth stretch then go on
/// side by side with the same input.
struct EnduranceBench {
    static constexpr int columns = 200;
    static constexpr int stretches = 10;
    std::int64_t ticks = 0; ///< of a stretch
    TickTimes first_moving, last_moving;
    TickTimes first_standing, last_standing;
    std::int64_t denormals = 0; ///< among the numbers of the last state

    /// Of the ninetieth percentile: one of the ticks that take back a variance, which take longer. How many
    /// they are is up to the motion and decides the median.
    double change_moving() const { return last_moving.p90 / first_moving.p90 - 1; }
    double change_standing() const { return last_standing.p90 / first_standing.p90 - 1; }
};

EnduranceBench run_endurance_bench(std::int64_t ticks, const RepetitionOptions& options,
                                   MultiplyAddProbe& probe, const std::function<void(double)>& on_share_done);

} // namespace dfdyn::tools
