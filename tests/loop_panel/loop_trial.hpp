// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/loop_panel/strangers_loop.hpp"
#include "tools/control/loop_setup.hpp"

#include <string>
#include <vector>

namespace dfdyn::tests {

/// What a loop did.
struct LoopTrial {
    std::string stop;                    ///< cause of a stop; empty: none
    double step = 0;                     ///< largest change of a command in a tick, relative to its limit
    double late_step = 0;                ///< the same in the second half of the run
    double speed = 0;                    ///< largest true speed of a joint, rad/s
    double error = 0;                    ///< tracking error, root mean square over joints and time, rad
    double second = 0;                   ///< its largest second
    std::string summary;                 ///< printed after the run
    std::vector<double> bandwidth_share; ///< of the observer, per joint, in the JSON
};

/// Runs a loop. `model`: null for none.
LoopTrial run_loop(const StrangersLoop& loop, bool observer, const tools::LoopModel* model,
                   double duration_s);

} // namespace dfdyn::tests
