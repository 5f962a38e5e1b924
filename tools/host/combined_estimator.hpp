// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/host/host_estimator.hpp"

#include <memory>
#include <vector>

namespace dfdyn::tools {

/// How many samples the combination remembers the members' errors for.
inline constexpr float combination_memory = 100;

struct CombinationMember {
    std::unique_ptr<HostEstimator> estimator;
    double innovation_limit; ///< of its model
};

/// Estimators of the same arm and outputs as one: each ticks, and their predictions are combined as
/// dfdyn::ForecastCombination does. It predicts where all members do; the status is that of the first that
/// does not, or has not learned. The normalised innovation squared is that of the member which it contradicts
/// least, in proportion to their limits, and on the scale of the first member's. A budget is each member's
/// own; from a sample that it does not suffice for in the same tick, the combination does not learn.
/// `members`: at least one.
std::unique_ptr<HostEstimator> combine(std::vector<CombinationMember> members, std::size_t outputs);

} // namespace dfdyn::tools
