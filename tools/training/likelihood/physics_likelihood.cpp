// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/physics_likelihood.hpp"

#include "tools/base/numerics/linear_algebra.hpp"

#include <cmath>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns C^-1 (y_k - Psi_k pi) in column k.
MatrixXd solved_residuals(const MatrixXd& solved_outputs, const MatrixXd& solved_columns,
                          const VectorXd& parameters) {
    MatrixXd residuals = solved_outputs;
    for (Index k = 0; k < residuals.cols(); ++k) {
        residuals.col(k) -= solved_columns.middleCols(k * parameters.size(), parameters.size()) * parameters;
    }
    return residuals;
}

/// Sets directions and weights; returns the gradient with respect to the columns. `integrated`: pi has a
/// prior, and its uncertainty is included.
MatrixXd add_gradients(const VarianceComponents& best, const MatrixXd& residuals,
                       const MatrixXd& solved_columns, bool integrated, Evidence& evidence) {
    const Index count = residuals.cols();
    const MatrixXd& root = best.at.covariance_root;
    const Index p = root.rows();
    const VectorXd precision = best.output_variance.cwiseInverse();
    evidence.directions.resize(residuals.rows(), count * (integrated ? p + 1 : 1));
    evidence.weights.resize(evidence.directions.cols());
    evidence.directions.leftCols(count) = residuals;
    evidence.weights.head(count) = precision;
    MatrixXd slope(solved_columns.rows(), solved_columns.cols());
    for (Index k = 0; k < count; ++k) {
        auto part = slope.middleCols(k * p, p);
        part.noalias() = -2 * precision[k] * residuals.col(k) * best.at.parameters.transpose();
        if (integrated) {
            auto uncertain = evidence.directions.middleCols(count + k * p, p);
            uncertain.noalias() = solved_columns.middleCols(k * p, p) * root;
            part.noalias() += 2 * precision[k] * uncertain * root.transpose();
            evidence.weights.segment(count + k * p, p).setConstant(precision[k]);
        }
    }
    return slope;
}

constexpr double log_prior_range = 15; // for columns of the outputs' size

} // namespace

LinearStatistics linear_statistics(const MatrixXd& outputs, const MatrixXd& columns,
                                   const MatrixXd& solved_outputs, const MatrixXd& solved_columns) {
    const Index count = outputs.cols();
    const Index p = columns.cols() / count;
    LinearStatistics statistics{outputs.rows(), {}, MatrixXd(p, count), VectorXd(count)};
    for (Index k = 0; k < count; ++k) {
        const auto psi = columns.middleCols(k * p, p);
        const MatrixXd square = psi.transpose() * solved_columns.middleCols(k * p, p);
        statistics.squares.emplace_back(0.5 * (square + square.transpose()));
        statistics.products.col(k) = psi.transpose() * solved_outputs.col(k);
        statistics.output_squares[k] = outputs.col(k).dot(solved_outputs.col(k));
    }
    return statistics;
}

Bounds PhysicsLikelihood::bounds() const {
    const Bounds own = physics_.bounds();
    const VectorXd range = VectorXd::Constant(prior_parameters(), log_prior_range);
    return {concatenated(own.lower, -range), concatenated(own.upper, range)};
}

VectorXd PhysicsLikelihood::start(const VectorXd& input) const {
    return concatenated(physics_.start(input), VectorXd::Zero(prior_parameters()));
}

std::optional<Evidence> PhysicsLikelihood::evaluate(const Covariance& covariance,
                                                    const VectorXd& parameters) const {
    const Index count = outputs_.cols();
    const VectorXd of_physics = parameters.head(parameters.size() - prior_parameters());
    const MatrixXd columns = physics_.evaluate(of_physics);
    const Index p = columns.cols() / count;
    const MatrixXd solved_outputs = covariance.solve(outputs_);
    const MatrixXd solved_columns = covariance.solve(columns);
    const auto best = best_variances(
        linear_statistics(outputs_, columns, solved_outputs, solved_columns), prior_,
        prior_ == PhysicsPrior::diagonal ? std::optional(VectorXd(parameters.tail(p))) : std::nullopt);
    if (!best) {
        return std::nullopt;
    }
    Evidence evidence;
    evidence.count = static_cast<double>(count);
    evidence.minus_two_log_likelihood = best->at.value + evidence.count * covariance.log_determinant();
    evidence.output_variance = best->output_variance;
    evidence.physics = {best->at.parameters, best->prior_variance};
    const MatrixXd slope =
        add_gradients(*best, solved_residuals(solved_outputs, solved_columns, best->at.parameters),
                      solved_columns, prior_ != PhysicsPrior::none, evidence);
    evidence.parameter_gradient =
        concatenated(physics_.pull_back(of_physics, slope), best->at.gradient.tail(prior_parameters()));
    return evidence;
}

} // namespace dfdyn::tools
