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

/// Common data of all draws of one case: the exact kernel's hyperparameters do not depend on the draw.
/// Thread-safe.
struct CaseMemory {
    std::mutex tuning;                 ///< held during the search for hyperparameters
    std::optional<TrainedModel> tuned; ///< with the features of one of the draws
};

using CaseMemories = std::map<std::string, CaseMemory>; ///< by the case's name

/// Common data of all cases of a plan.
struct CaseContext {
    const RobotChoice& robot;
    OutputKind outputs;
    const Recording& start; ///< source of hyperparameters and initial state
    int threads = 1;        ///< >= 1, per training; does not change its result
};

/// Reads the plan's robot. Throws InputError if this fails.
Robot robot_of(const RobotChoice& choice);

/// Trains `one` for the draw of random features `seed`: hyperparameters from `context.start`, unless `memory`
/// already has them, then the batch solution over it as the initial state. No sample is rejected for its
/// innovation, because the paper's protocol learns from all. `progress` receives the completed share, 0 … 1.
/// Equal cases, seeds and data give equal models, independent of earlier calls. Throws InputError as `train`
/// does, and for an unavailable case.
TrainedModel train_case(const Case& one, const CaseContext& context, std::uint64_t seed, CaseMemory& memory,
                        const std::function<void(double)>& progress);

} // namespace dfdyn::tools
