// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/replay/opponents/opponents.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Alternative methods for comparison with a plan's cases.
struct PlanOpponents {
    std::vector<OpponentErrors> errors; ///< NaN without a forecast
    std::string no_rigid_body;          ///< why there is no rigid body; empty: there is one
};

/// Returns the one-step nRMSE of each output over all subsets of a plan. The methods are persistence and
/// AR(2), which restart in each subset, and two rigid bodies with friction (`fit_rigid_body`), fitted to the
/// training log. Rows before the largest window of any case, and rows without a forecast, are left out.
PlanOpponents plan_opponents(const Plan& plan, const PlanData& data);

} // namespace dfdyn::tools
