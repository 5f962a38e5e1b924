// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/experiment/run/train_case.hpp"
#include "tools/experiment/run/unit_result.hpp"

#include <functional>

namespace dfdyn::tools {

/// The paper's protocol (section "Inverse Dynamics Learning on iCub") for one case and one draw: start from
/// `data.start`, online over `data.online`, then each subset from the state at the end of that, learning on,
/// with an empty window. `memories`: one for each case of the plan. `threads`: of the training, >= 1.
/// `progress`: told the share that is done, 0 … 1.
/// Deterministic but for the times.
UnitResult run_unit(const Plan& plan, const PlanData& data, const Case& one, std::uint64_t seed,
                    CaseMemories& memories, int threads, const std::function<void(double)>& progress);

} // namespace dfdyn::tools
