// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/suites/timed_loop.hpp"

#include <vector>

namespace dfdyn::tools {

/// Quantiles of one time of all ticks of a loop, µs.
struct LoopTimes {
    double median = 0, p99 = 0, p999 = 0, p9999 = 0, most = 0;
};

LoopTimes summarise(std::vector<double> times_us);

/// How a periodic loop at 1 kHz keeps its time beside a load: six joints, six outputs, model NP with input
/// DFR and 2d = 200 columns, every sample learned as soon as it is there.
struct LoopBench {
    PaceCounters pace;
    LoopTimes late;     ///< from when a tick was due until it began
    LoopTimes duration; ///< of the estimator's tick
    std::size_t learned = 0;
    std::string not_real_time; ///< what the kernel did not grant; empty: all of it
    int cores = 0;             ///< that the process may use
};

/// As `time_loop`, beside a load.
LoopBench run_loop_bench(double duration_s);

} // namespace dfdyn::tools
