// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/replay/opponents/opponents.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// What a plan's cases are compared with.
struct PlanOpponents {
    std::vector<OpponentErrors> errors; ///< NaN where there is no forecast
    std::string no_rigid_body;          ///< why there is no rigid body; empty: there is one
};

/// nRMSE of each output over all subsets of a plan, one step ahead: of persistence and AR(2), which start
/// again in each subset, and of the two rigid bodies with friction (`fit_rigid_body`), fitted to the whole
/// training log. A subset's rows before the largest window of any case do not count, nor do rows without a
/// forecast.
PlanOpponents plan_opponents(const Plan& plan, const PlanData& data);

} // namespace dfdyn::tools
