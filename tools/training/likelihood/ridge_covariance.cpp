// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/ridge_covariance.hpp"

#include <cmath>
#include <utility>

namespace dfdyn::tools {

using Eigen::MatrixXd;

std::optional<RidgeCovariance> RidgeCovariance::of(const MatrixXd& phi, double noise_ratio) {
    MatrixXd information = MatrixXd::Zero(phi.cols(), phi.cols());
    information.selfadjointView<Eigen::Lower>().rankUpdate(phi.transpose());
    information.diagonal().array() += noise_ratio;
    Eigen::LLT<MatrixXd> factor(information);
    if (factor.info() != Eigen::Success) {
        return std::nullopt;
    }
    return RidgeCovariance(phi, noise_ratio, std::move(factor));
}

double RidgeCovariance::log_determinant() const {
    return static_cast<double>(phi_->rows() - phi_->cols()) * std::log(noise_ratio_) +
           2 * factor_.matrixLLT().diagonal().array().log().sum();
}

MatrixXd RidgeCovariance::solve(const MatrixXd& right_hand_sides) const {
    const MatrixXd weights = factor_.solve(phi_->transpose() * right_hand_sides);
    return (right_hand_sides - *phi_ * weights) / noise_ratio_;
}

MatrixXd RidgeCovariance::inverse_information() const {
    return factor_.solve(MatrixXd::Identity(phi_->cols(), phi_->cols()));
}

double RidgeCovariance::scaled_trace(const MatrixXd& inverse_information) const {
    return static_cast<double>(phi_->rows() - phi_->cols()) + noise_ratio_ * inverse_information.trace();
}

} // namespace dfdyn::tools
