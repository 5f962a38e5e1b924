// SPDX-License-Identifier: Apache-2.0
#include "tools/training/feature_likelihood.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The features of every sample, and what the chain rule needs of them.
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

/// From the gradient with respect to phi to the one with respect to the phases.
MatrixXd pull_back_to_phase(const Features& features, const MatrixXd& phi_gradient) {
    const Eigen::Index d = features.phase.cols();
    return features.phi.leftCols(d).cwiseProduct(phi_gradient.rightCols(d)) -
           features.phi.rightCols(d).cwiseProduct(phi_gradient.leftCols(d));
}

/// Likelihood of the outputs under C = phi phi' + r I by the matrix inversion lemma, and its derivatives.
struct RidgeEvidence {
    double minus_two_log_likelihood = 0;
    double noise_ratio_gradient = 0; ///< with respect to log r
    MatrixXd phi_gradient;
    VectorXd output_variance;
};

std::optional<RidgeEvidence> ridge_evidence(const MatrixXd& phi, const MatrixXd& outputs,
                                            double noise_ratio) {
    const Eigen::Index columns = phi.cols();
    MatrixXd information = MatrixXd::Zero(columns, columns);
    information.selfadjointView<Eigen::Lower>().rankUpdate(phi.transpose());
    information.diagonal().array() += noise_ratio;
    const Eigen::LLT<MatrixXd> factor(information);
    if (factor.info() != Eigen::Success) {
        return std::nullopt;
    }
    const auto samples = static_cast<double>(phi.rows());
    const auto count = static_cast<double>(outputs.cols());
    const MatrixXd weights = factor.solve(phi.transpose() * outputs);
    const MatrixXd solved = (outputs - phi * weights) / noise_ratio; // C^-1 Y
    const MatrixXd covariance = factor.solve(MatrixXd::Identity(columns, columns));
    const double log_determinant = (samples - static_cast<double>(columns)) * std::log(noise_ratio) +
                                   2 * factor.matrixLLT().diagonal().array().log().sum();
    RidgeEvidence evidence;
    evidence.output_variance = outputs.cwiseProduct(solved).colwise().sum().transpose() / samples;
    evidence.minus_two_log_likelihood =
        samples * ((2 * std::numbers::pi * evidence.output_variance).array().log().sum() + count) +
        count * log_determinant;
    const VectorXd precision = evidence.output_variance.cwiseInverse();
    const double trace =
        samples - static_cast<double>(columns) + noise_ratio * covariance.trace(); // r tr C^-1
    evidence.noise_ratio_gradient =
        count * trace - noise_ratio * solved.colwise().squaredNorm().dot(precision.transpose());
    evidence.phi_gradient.noalias() = 2 * count * phi * covariance;
    evidence.phi_gradient.noalias() -= 2 * solved * precision.asDiagonal() * weights.transpose();
    return evidence;
}

} // namespace

FeatureLikelihood::FeatureLikelihood(const InputMap& input, MatrixXd outputs, MatrixXd omega)
    : input_(input), outputs_(std::move(outputs)), omega_(std::move(omega)) {}

std::optional<FeatureLikelihood::Value> FeatureLikelihood::evaluate(const VectorXd& theta) const {
    const double noise_ratio = std::exp(theta[0]);
    const double length_scale = std::exp(theta[1]);
    const VectorXd own = theta.tail(theta.size() - 2);
    const Features features = features_of(input_.inputs(own), omega_, length_scale);
    const std::optional<RidgeEvidence> evidence = ridge_evidence(features.phi, outputs_, noise_ratio);
    if (!evidence) {
        return std::nullopt;
    }
    const MatrixXd phase_gradient = pull_back_to_phase(features, evidence->phi_gradient);
    Value value{{evidence->minus_two_log_likelihood, VectorXd(theta.size())}, evidence->output_variance};
    value.point.gradient << evidence->noise_ratio_gradient,
        -phase_gradient.cwiseProduct(features.phase).sum(),
        input_.pull_back(own, phase_gradient * omega_ / length_scale);
    if (!std::isfinite(value.point.value) || !value.point.gradient.allFinite()) {
        return std::nullopt;
    }
    return value;
}

} // namespace dfdyn::tools
