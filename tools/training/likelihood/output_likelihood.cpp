// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/output_likelihood.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

std::optional<Evidence> ProfiledVarianceLikelihood::evaluate(const Covariance& covariance,
                                                             const Eigen::VectorXd& parameters) const {
    const auto samples = static_cast<double>(outputs_.rows());
    Evidence evidence;
    evidence.count = static_cast<double>(outputs_.cols());
    evidence.directions = covariance.solve(outputs_);
    evidence.output_variance =
        outputs_.cwiseProduct(evidence.directions).colwise().sum().transpose() / samples;
    const double log_variances = (2 * std::numbers::pi * evidence.output_variance).array().log().sum();
    evidence.minus_two_log_likelihood =
        samples * (log_variances + evidence.count) + evidence.count * covariance.log_determinant();
    evidence.weights = evidence.output_variance.cwiseInverse();
    evidence.parameter_gradient = Eigen::VectorXd::Zero(parameters.size());
    return evidence;
}

} // namespace dfdyn::tools
