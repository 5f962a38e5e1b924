// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/experiment/run/plan_opponents.hpp"
#include "tools/experiment/run/unit_result.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A unit that could not be done.
struct FailedUnit {
    std::string case_name;
    std::uint64_t seed;
    std::string reason; ///< one line
};

struct EvaluationResults {
    /// In the plan's order: case by case, draw by draw; with errors as `keep_common_ticks` leaves them.
    std::vector<UnitResult> units;
    std::vector<FailedUnit> failed;
    std::size_t reused = 0;  ///< of the units, found in the folder
    PlanOpponents opponents; ///< what the units are compared with; `run_plan` leaves it empty
};

struct RunOptions {
    std::filesystem::path folder; ///< each unit is folder/cases/CASE/SEED.json
    int jobs = 1;                 ///< units at a time, >= 1; the results do not depend on it
    bool fresh = false;           ///< do everything again
};

/// Does what is left to do of a plan. A unit whose file is there is read instead, if the file says that the
/// plan's part that concerns it, the recordings' checksums and the program are the same. The files appear
/// whole or not at all, so a run that was ended goes on where it was. `progress`: told how many units are
/// done (reused and failed included, and the share of those in work), from the calling thread. An InputError
/// in one unit does not end the others; any other exception does.
EvaluationResults run_plan(const Plan& plan, const PlanData& data, const RunOptions& options,
                           const std::function<void(double)>& progress);

} // namespace dfdyn::tools
