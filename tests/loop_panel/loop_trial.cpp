// SPDX-License-Identifier: Apache-2.0
#include "tests/loop_panel/loop_trial.hpp"

#include "tools/control/closed_loop.hpp"
#include "tools/control/report/loop_peaks.hpp"
#include "tools/control/report/loop_summary.hpp"
#include "tools/control/report/tracking.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace dfdyn::tests {

using namespace tools;

LoopTrial run_loop(const StrangersLoop& stranger, bool observer, const LoopModel* model, double duration_s) {
    LoopLimits limits;
    if (!observer) {
        limits.observer_bandwidth = {0};
    }
    ClosedLoop loop(stranger.robot, stranger.scenario, "scenario", model,
                    stranger.bus ? &*stranger.bus : nullptr, limits);
    Tracking tracking(1, 1 / stranger.scenario.controller.rate_hz);
    LoopPeaks peaks, late_peaks;
    loop.run_to(duration_s, [&](const ClosedLoopInstant& instant) {
        tracking.add(instant.time_s, instant.error, loop.loop().feed_forward().learned_share());
        peaks.add(instant.command, loop.plant().truth().velocity);
        if (instant.time_s >= duration_s / 2) {
            late_peaks.add(instant.command);
        }
    });
    LoopTrial trial;
    trial.stop = loop.loop().state() == LoopState::running ? "" : name(loop.loop().cause());
    const JointVector& limit = *stranger.scenario.actuators.torque_limit;
    trial.step = peaks.torque_step().cwiseQuotient(limit).maxCoeff();
    if (late_peaks.torque_step().size() > 0) { // a loop that stops ends early
        trial.late_step = late_peaks.torque_step().cwiseQuotient(limit).maxCoeff();
    }
    trial.speed = peaks.speed().maxCoeff();
    for (const TrackingWindow& window : tracking.windows()) {
        trial.second = std::max(trial.second, window.all);
        trial.error += window.all * window.all / static_cast<double>(tracking.windows().size());
    }
    trial.error = std::sqrt(trial.error);
    std::ostringstream summary;
    print_loop(summary, loop.loop());
    trial.summary = summary.str();
    trial.bandwidth_share =
        loop_json("", loop.loop(), peaks).at("observer_bandwidth_share").get<std::vector<double>>();
    return trial;
}

} // namespace dfdyn::tests
