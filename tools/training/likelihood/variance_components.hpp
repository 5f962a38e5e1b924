// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/likelihood/variance_criterion.hpp"

#include <Eigen/Core>

#include <optional>

namespace dfdyn::tools {

/// The variances at their most likely values.
struct VarianceComponents {
    Eigen::VectorXd output_variance; ///< m: v_k
    Eigen::VectorXd prior_variance;  ///< p: gamma^2 of each column; empty without a prior
    VarianceCriterion at;
};

/// Minimises the criterion from a start determined by the statistics: some steps of expectation-maximization,
/// then damped Newton steps until the gradient vanishes within rounding errors. By the envelope theorem, the
/// derivatives of the minimum are then those at fixed variances. gamma^2 stays within e^(+-25) of its start.
/// `log_prior` (one per gamma^2 of the criterion) holds the prior fixed. This is recommended for a diagonal
/// prior, which has many local minima, one for each set of columns without influence. Returns nothing without
/// a minimum.
std::optional<VarianceComponents>
best_variances(const LinearStatistics& statistics, PhysicsPrior prior,
               const std::optional<Eigen::VectorXd>& log_prior = std::nullopt);

} // namespace dfdyn::tools
