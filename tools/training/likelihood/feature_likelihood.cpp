// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/feature_likelihood.hpp"

#include "tools/training/likelihood/covariance.hpp"
#include "tools/training/likelihood/marginal_likelihood.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <optional>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Features of every sample, and intermediate results for the chain rule.
struct Features {
    MatrixXd phase; ///< N x d: omega xi / l
    MatrixXd phi;   ///< N x 2d
};

Features features_of(const MatrixXd& inputs, const MatrixXd& omega, double length_scale) {
    Features features;
    features.phase = inputs * omega.transpose() / length_scale;
    const double amplitude = 1 / std::sqrt(static_cast<double>(omega.rows()));
    features.phi.resize(inputs.rows(), 2 * omega.rows());
    features.phi << amplitude * features.phase.array().cos().matrix(),
        amplitude * features.phase.array().sin().matrix();
    return features;
}

/// Converts the gradient with respect to phi to that with respect to the phases.
MatrixXd pull_back_to_phase(const Features& features, const MatrixXd& phi_gradient) {
    const Eigen::Index d = features.phase.cols();
    return features.phi.leftCols(d).cwiseProduct(phi_gradient.rightCols(d)) -
           features.phi.rightCols(d).cwiseProduct(phi_gradient.leftCols(d));
}

/// C = Phi Phi' + r I by the matrix inversion lemma. Refers to Phi, which must outlive it.
class RidgeCovariance final : public Covariance {
  public:
    /// Returns nothing if Phi' Phi + r I is not positive definite in double precision. O(N (2d)^2 + (2d)^3).
    static std::optional<RidgeCovariance> of(const MatrixXd& phi, double noise_ratio) {
        MatrixXd information = MatrixXd::Zero(phi.cols(), phi.cols());
        information.selfadjointView<Eigen::Lower>().rankUpdate(phi.transpose());
        information.diagonal().array() += noise_ratio;
        Eigen::LLT<MatrixXd> factor(information);
        if (factor.info() != Eigen::Success) {
            return std::nullopt;
        }
        return RidgeCovariance(phi, noise_ratio, std::move(factor));
    }

    double log_determinant() const override {
        return static_cast<double>(phi_->rows() - phi_->cols()) * std::log(noise_ratio_) +
               2 * factor_.matrixLLT().diagonal().array().log().sum();
    }

    /// O(N 2d) per column of B.
    MatrixXd solve(const MatrixXd& right_hand_sides) const override {
        const MatrixXd weights = factor_.solve(phi_->transpose() * right_hand_sides);
        return (right_hand_sides - *phi_ * weights) / noise_ratio_;
    }

    /// Returns (Phi' Phi + r I)^-1, 2d x 2d; C^-1 Phi = Phi times it.
    MatrixXd inverse_information() const {
        return factor_.solve(MatrixXd::Identity(phi_->cols(), phi_->cols()));
    }

    /// Returns r tr C^-1, from inverse_information().
    double scaled_trace(const MatrixXd& inverse_information) const {
        return static_cast<double>(phi_->rows() - phi_->cols()) + noise_ratio_ * inverse_information.trace();
    }

  private:
    RidgeCovariance(const MatrixXd& phi, double noise_ratio, Eigen::LLT<MatrixXd> factor)
        : phi_(&phi), noise_ratio_(noise_ratio), factor_(std::move(factor)) {}

    const MatrixXd* phi_;
    double noise_ratio_;
    Eigen::LLT<MatrixXd> factor_;
};

/// Gradient with respect to the parts of C = phi phi' + r I.
struct RidgeGradient {
    double log_noise_ratio = 0;
    MatrixXd phi;
};

RidgeGradient contract(const Evidence& evidence, const RidgeCovariance& covariance, const MatrixXd& phi,
                       double noise_ratio) {
    const MatrixXd inverse = covariance.inverse_information();
    RidgeGradient gradient;
    gradient.log_noise_ratio =
        evidence.count * covariance.scaled_trace(inverse) -
        noise_ratio * evidence.directions.colwise().squaredNorm().dot(evidence.weights.transpose());
    gradient.phi.noalias() = 2 * evidence.count * phi * inverse;
    gradient.phi.noalias() -=
        2 * evidence.directions * (evidence.weights.asDiagonal() * (evidence.directions.transpose() * phi));
    return gradient;
}

} // namespace

std::optional<LikelihoodValue> FeatureLikelihood::evaluate(const VectorXd& theta) const {
    const double noise_ratio = std::exp(theta[0]);
    const double length_scale = std::exp(theta[1]);
    const VectorXd input = theta.segment(kernel_parameters, input_.bounds().lower.size());
    const Features features = features_of(input_.inputs(input), omega_, length_scale);
    const auto covariance = RidgeCovariance::of(features.phi, noise_ratio);
    if (!covariance) {
        return std::nullopt;
    }
    const auto evidence = outputs_.evaluate(*covariance, theta.tail(theta.size() - kernel_parameters));
    if (!evidence) {
        return std::nullopt;
    }
    const RidgeGradient gradient = contract(*evidence, *covariance, features.phi, noise_ratio);
    const MatrixXd phase_gradient = pull_back_to_phase(features, gradient.phi);
    LikelihoodValue value{
        evidence->minus_two_log_likelihood, {}, evidence->output_variance, evidence->physics};
    value.gradient = joined(gradient.log_noise_ratio, -phase_gradient.cwiseProduct(features.phase).sum(),
                            evidence->parameter_gradient);
    value.gradient.segment(kernel_parameters, input.size()) +=
        input_.pull_back(input, phase_gradient * omega_ / length_scale);
    return finite_or_nothing(std::move(value));
}

} // namespace dfdyn::tools
