// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/system/pace.hpp"

#include <functional>
#include <string>
#include <vector>

namespace dfdyn::tools {

struct TimedLoopOptions {
    double period_s = 0.001;
    double duration_s = 600;
    bool load = true; ///< another thread works on memory all the while, on another core where there is one
};

/// How well a periodic loop kept its time.
struct TimedLoop {
    PaceCounters pace;
    std::vector<double> late_us;     ///< of each tick: from when it was due until it began
    std::vector<double> duration_us; ///< of each tick: from its begin to its end
    std::string not_real_time;       ///< what the kernel did not grant, and why; empty: all of it
    int cores = 0;                   ///< that the process may use; with one, the load shares it
};

/// Calls `tick` once per period, at absolute times, with its number; a tick that begins late is run at once.
/// Asks for a real-time priority and locked memory, on a thread of its own, on the last core that the process
/// may use; the load is on the first. Memory stays locked. Throws InputError unless
/// 0 < period <= duration <= one hour.
TimedLoop time_loop(const TimedLoopOptions& options, const std::function<void(std::size_t)>& tick);

} // namespace dfdyn::tools
