// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/suites/timed_loop.hpp"
#include "tools/bench/timing/tick_times.hpp"

#include <cstddef>
#include <string>

namespace dfdyn::tools {

/// Timing of a periodic loop at 1 kHz under load: six joints, six outputs, model NP with input DFR and 2d =
/// 200 columns, where every sample is learned immediately.
struct LoopBench {
    PaceCounters pace;
    TickTimes late;     ///< from a tick's due time to its start
    TickTimes duration; ///< of the estimator's tick
    std::size_t learned = 0;
    std::string not_real_time; ///< privileges that the system refused; empty: none
    int cores = 0;             ///< available to the process
};

/// Runs `time_loop` under load.
LoopBench run_loop_bench(double duration_s);

} // namespace dfdyn::tools
