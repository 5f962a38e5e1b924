// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/run_time/runtime_estimator.hpp"

#include <memory>
#include <vector>

namespace dfdyn::tools {

/// Memory of the combination for the members' errors (s).
inline constexpr double combination_memory_s = 0.8;
/// Time between two copies of the members' weights (s). Errors ahead use weights that are one to two periods
/// old.
inline constexpr double held_weights_period_s = 0.2;

struct CombinationMember {
    std::unique_ptr<RuntimeEstimator> estimator;
    double innovation_limit;       ///< limit of its model
    std::vector<double> noise_std; ///< of its model, m values
    bool calibrated = false;       ///< its model has measured uncertainties away from its data
};

/// Returns an estimator that combines several estimators of the same arm and outputs as
/// dfdyn::ForecastCombination does. A tick that follows a learned sample is weighted by the members' errors
/// one step ahead, any other prediction by their errors 0.2 to 0.4 s ahead. Both are scaled by the ratio of
/// the present variances to those of the samples with these errors. While no error is known, the variances
/// determine the weights. They count as calibrated if all members are calibrated.
///
/// - Prediction: requires the predictions of all members. The status comes from the first member without a
///   prediction, or without learning.
/// - Normalised innovation squared: from the member with the smallest value relative to its limit, scaled
///   to the first member's limit.
/// - Budget: each member has the complete budget. The combination learns from every measured sample that at
///   least one member accepted, for any budget > 0. With Budget::predict_only() its weights follow the
///   variances alone.
///
/// `members`: at least one. `sample_period_s` > 0.
std::unique_ptr<RuntimeEstimator> combine(std::vector<CombinationMember> members, std::size_t outputs,
                                          double sample_period_s);

} // namespace dfdyn::tools
