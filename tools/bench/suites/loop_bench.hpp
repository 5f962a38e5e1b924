// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/suites/timed_loop.hpp"

#include <vector>

namespace dfdyn::tools {

/// Quantiles over all ticks of a loop, µs.
struct LoopTimes {
    double median = 0, p99 = 0, p999 = 0, p9999 = 0, most = 0;
};

LoopTimes summarise(std::vector<double> times_us);

/// Timing of a periodic loop at 1 kHz under load: six joints, six outputs, model NP with input DFR and 2d =
/// 200 columns, where every sample is learned immediately.
struct LoopBench {
    PaceCounters pace;
    LoopTimes late;     ///< from a tick's due time to its start
    LoopTimes duration; ///< of the estimator's tick
    std::size_t learned = 0;
    std::string not_real_time; ///< privileges that the system refused; empty: none
    int cores = 0;             ///< available to the process
};

/// Runs `time_loop` under load.
LoopBench run_loop_bench(double duration_s);

} // namespace dfdyn::tools
