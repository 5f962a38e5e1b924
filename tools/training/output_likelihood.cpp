// SPDX-License-Identifier: Apache-2.0
#include "tools/training/output_likelihood.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

Evidence ProfiledVarianceLikelihood::evaluate(const CovarianceFactor& factor,
                                              const Eigen::VectorXd& /*parameters*/) const {
    const auto samples = static_cast<double>(outputs_.rows());
    const auto count = static_cast<double>(outputs_.cols());
    const Eigen::MatrixXd solved = factor.solve(outputs_);
    Evidence evidence;
    evidence.output_variance = outputs_.cwiseProduct(solved).colwise().sum().transpose() / samples;
    const double log_variances = (2 * std::numbers::pi * evidence.output_variance).array().log().sum();
    evidence.minus_two_log_likelihood = samples * (log_variances + count) + count * factor.log_determinant();
    evidence.covariance_gradient = count * factor.inverse();
    const Eigen::VectorXd weights = evidence.output_variance.cwiseInverse();
    evidence.covariance_gradient.noalias() -= solved * weights.asDiagonal() * solved.transpose();
    evidence.parameter_gradient = Eigen::VectorXd(0);
    return evidence;
}

} // namespace dfdyn::tools
