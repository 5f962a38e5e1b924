// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/run_time/host_estimator.hpp"

#include <memory>
#include <vector>

namespace dfdyn::tools {

/// How long the combination remembers the members' errors (s).
inline constexpr double combination_memory_s = 0.8;
/// Between two copies of the members' weights (s): errors ahead are those of weights one to two periods old.
inline constexpr double held_weights_period_s = 0.2;

struct CombinationMember {
    std::unique_ptr<HostEstimator> estimator;
    double innovation_limit;       ///< of its model
    std::vector<double> noise_std; ///< of its model, m values
    bool calibrated = false;       ///< its model has measured what it knows away from its data
};

/// Estimators of the same arm and outputs as one: each ticks, and their predictions are combined as
/// dfdyn::ForecastCombination does, by errors one step and 0.2 to 0.4 s ahead and by the members' variances
/// at each input, which count as calibrated ones while no error is known, if all members are. It predicts
/// where all members do; the status is that of the first that does not, or has not learned. The normalised
/// innovation squared is that of the member which it contradicts least, in proportion to their limits, and on
/// the scale of the first member's. A budget is each member's own. The combination learns from every measured
/// sample that at least one member did not refuse, whatever a budget > 0 suffices for; with
/// Budget::predict_only() its weights follow the variances alone. `members`: at least one. `sample_period_s`
/// > 0.
std::unique_ptr<HostEstimator> combine(std::vector<CombinationMember> members, std::size_t outputs,
                                       double sample_period_s);

} // namespace dfdyn::tools
