// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/likelihood/output_likelihood.hpp"

#include <Eigen/Core>

#include <cmath>
#include <optional>

namespace dfdyn::tools {

struct LikelihoodValue {
    double minus_two_log_likelihood = 0;
    Eigen::VectorXd gradient;        ///< one entry per element of theta
    Eigen::VectorXd output_variance; ///< m: rho_k^2; for P sigma_k^2
    PhysicsFit physics;              ///< empty for NP
};

/// -2 log marginal likelihood as a function of the hyperparameters theta.
class Likelihood {
  public:
    Likelihood() = default;
    Likelihood(const Likelihood&) = delete;
    Likelihood& operator=(const Likelihood&) = delete;
    virtual ~Likelihood() = default;

    /// Returns nothing if the covariance cannot be factored or a number is not finite.
    virtual std::optional<LikelihoodValue> evaluate(const Eigen::VectorXd& theta) const = 0;
};

/// Returns `value`, or nothing if it is not finite.
inline std::optional<LikelihoodValue> finite_or_nothing(LikelihoodValue value) {
    if (!std::isfinite(value.minus_two_log_likelihood) || !value.gradient.allFinite()) {
        return std::nullopt;
    }
    return value;
}

} // namespace dfdyn::tools
