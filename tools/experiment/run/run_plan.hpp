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

/// A unit that failed.
struct FailedUnit {
    std::string case_name;
    std::uint64_t seed;
    std::string reason; ///< one line
};

struct EvaluationResults {
    /// In the plan's order (cases, then draws), with errors as after `keep_common_ticks`.
    std::vector<UnitResult> units;
    std::vector<FailedUnit> failed;
    std::size_t reused = 0;  ///< units read from existing files
    PlanOpponents opponents; ///< alternative methods; not set by `run_plan`
};

struct RunOptions {
    std::filesystem::path folder; ///< each unit is folder/cases/CASE/SEED.json
    int jobs = 1;                 ///< units in parallel, >= 1; the results do not depend on it
    bool fresh = false;           ///< repeat all units
};

/// Runs the remaining units of a plan. A unit with an existing file is read instead, if the file has the same
/// plan (the part that concerns the unit), checksums of the recordings, and program. Files are replaced
/// atomically, so that an aborted run can continue. `progress` receives the number of completed units
/// (including reused and failed ones, and the share of those in progress), in the calling thread. After an
/// InputError in one unit the others continue; any other exception ends the run.
EvaluationResults run_plan(const Plan& plan, const PlanData& data, const RunOptions& options,
                           const std::function<void(double)>& progress);

} // namespace dfdyn::tools
