// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/experiment/plan/plan.hpp"
#include "tools/robot/robot.hpp"

#include <functional>
#include <map>
#include <mutex>
#include <optional>

namespace dfdyn::tools {

/// What the draws of one case share: the exact kernel's hyperparameters depend on no draw. Any thread may use
/// it.
struct CaseMemory {
    std::mutex tuning;                 ///< held while the hyperparameters are sought
    std::optional<TrainedModel> tuned; ///< with the features of some draw
};

using CaseMemories = std::map<std::string, CaseMemory>; ///< by the case's name

/// What every case of a plan shares.
struct CaseContext {
    const RobotChoice& robot;
    OutputKind outputs;
    const Recording& start; ///< hyperparameters and start come from it
    int threads = 1;        ///< >= 1, of each training; does not change its result
};

/// Reads the plan's robot; throws InputError when it cannot.
Robot robot_of(const RobotChoice& choice);

/// Trains `one` for the draw of random features `seed`: hyperparameters from `context.start`, unless `memory`
/// has them already, then the batch solution over it as the start. No sample is refused for its
/// innovation: the paper's protocol learns from all. `progress`: told the share that is done, 0 … 1. The same
/// for the same case, seed and data, whatever was trained before. Throws InputError as `train` does, and for
/// a case that is not available.
TrainedModel train_case(const Case& one, const CaseContext& context, std::uint64_t seed, CaseMemory& memory,
                        const std::function<void(double)>& progress);

} // namespace dfdyn::tools
