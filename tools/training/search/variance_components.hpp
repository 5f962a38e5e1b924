// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/search/variance_criterion.hpp"

#include <Eigen/Core>

#include <optional>

namespace dfdyn::tools {

/// The variances at their most likely values.
struct VarianceComponents {
    Eigen::VectorXd output_variance; ///< m: v_k
    Eigen::VectorXd prior_variance;  ///< p: gamma^2 of each column; empty without prior
    VarianceCriterion at;
};

/// Minimises the criterion from a start that the statistics fix: some steps of expectation-maximisation, then
/// damped Newton steps until the gradient vanishes to rounding, so that by the envelope theorem the
/// derivatives of the minimum are those at fixed variances. gamma^2 stays within e^(+-25) of where it starts.
/// `log_prior` (one per gamma^2 of the criterion) holds the prior fixed. A diagonal prior should be held: it
/// has many local minima, one for each set of columns that the data leave out. Nothing without a minimum.
std::optional<VarianceComponents>
best_variances(const LinearStatistics& statistics, PhysicsPrior prior,
               const std::optional<Eigen::VectorXd>& log_prior = std::nullopt);

} // namespace dfdyn::tools
