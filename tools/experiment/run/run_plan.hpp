// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/experiment/run/job_result.hpp"
#include "tools/experiment/run/plan_opponents.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A job that failed.
struct FailedJob {
    std::string case_name;
    std::uint64_t seed;
    std::string reason; ///< one line
};

struct EvaluationResults {
    /// In the plan's order (cases, then draws), with errors as after `keep_common_ticks`.
    std::vector<JobResult> jobs;
    std::vector<FailedJob> failed;
    std::size_t reused = 0;  ///< jobs read from existing files
    PlanOpponents opponents; ///< alternative methods; not set by `run_plan`
};

struct RunOptions {
    std::filesystem::path folder; ///< each job is folder/cases/CASE/SEED.json
    int jobs = 1;                 ///< jobs in parallel, >= 1; the results do not depend on it
    bool fresh = false;           ///< repeat all jobs
};

/// Runs the remaining jobs of a plan. A job with an existing file is read instead if its part of the plan,
/// the recordings' checksums and the program are the same. Files are replaced atomically, so that an aborted
/// run can continue. `progress` receives the number of completed jobs (including reused and failed ones, and
/// the share of those in progress), in the calling thread. After an InputError in one job the others
/// continue. Throws InputError at the first result that cannot be written; any other exception ends the run
/// as well.
EvaluationResults run_plan(const Plan& plan, const PlanData& data, const RunOptions& options,
                           const std::function<void(double)>& progress);

} // namespace dfdyn::tools
