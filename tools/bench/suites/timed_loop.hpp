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
    bool load = true; ///< another thread uses memory all the time, on another core if there is one
};

/// Timing of a periodic loop.
struct TimedLoop {
    PaceCounters pace;
    std::vector<double> late_us;     ///< per tick: from its due time to its start
    std::vector<double> duration_us; ///< per tick: from its start to its end
    std::string not_real_time;       ///< privileges that the system refused, and why; empty: none
    int cores = 0;                   ///< available to the process; with one core, the load shares it
};

/// Calls `tick` with its number once per period, at absolute times; a late tick runs immediately. Requests a
/// real-time priority and locked memory, in a separate thread on the last core that the process may use; the
/// load runs on the first one. Memory remains locked. Throws InputError unless 0 < period <= duration <= one
/// hour.
TimedLoop time_loop(const TimedLoopOptions& options, const std::function<void(std::size_t)>& tick);

} // namespace dfdyn::tools
