// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/experiment/run/job_result.hpp"
#include "tools/experiment/run/train_case.hpp"

#include <functional>

namespace dfdyn::tools {

/// Runs the paper's protocol (Section VI) for one case and one draw: the initial state from `data.start`,
/// online learning over `data.online`, then each subset from the resulting state, with learning and an empty
/// window. `memories`: one for each case of the plan. `threads`: for training, >= 1. `progress` receives the
/// completed share, 0 … 1. Deterministic except for the times.
JobResult run_job(const Plan& plan, const PlanData& data, const Case& one, std::uint64_t seed,
                  CaseMemories& memories, int threads, const std::function<void(double)>& progress);

} // namespace dfdyn::tools
