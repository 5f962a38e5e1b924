// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/variance_criterion.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <numbers>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Sums over the columns that have the same gamma^2, in rows.
MatrixXd gathered(const MatrixXd& per_column, PhysicsPrior prior) {
    return prior == PhysicsPrior::shared ? MatrixXd(per_column.colwise().sum()) : per_column;
}

/// Common terms of value, gradient and Hessian at one x.
struct Point {
    VectorXd noise;                 // v_k
    VectorXd prior;                 // p, or empty
    VectorXd parameters;            // pi
    MatrixXd root;                  // W
    MatrixXd covariance;            // W W'
    double log_determinant = 0;     // of the information matrix
    std::vector<MatrixXd> products; // (W W') A_k
    MatrixXd slopes;                // p x m: b_k - A_k pi
    VectorXd residuals;             // m: (y_k - Psi_k pi)' C^-1 (y_k - Psi_k pi)
};

std::optional<Point> point_at(const LinearStatistics& statistics, PhysicsPrior prior, const VectorXd& x) {
    const Index outputs = outputs_of(statistics);
    Point point;
    point.noise = x.head(outputs).array().exp();
    point.prior = spread_prior(statistics, prior, x);
    MatrixXd information = MatrixXd::Zero(columns_of(statistics), columns_of(statistics));
    information.diagonal().head(point.prior.size()) = point.prior.cwiseInverse();
    for (Index k = 0; k < outputs; ++k) {
        information += statistics.squares[static_cast<std::size_t>(k)] / point.noise[k];
    }
    const Eigen::LLT<MatrixXd> factor(information);
    if (factor.info() != Eigen::Success || !factor.matrixLLT().diagonal().allFinite()) {
        return std::nullopt;
    }
    point.log_determinant = 2 * factor.matrixLLT().diagonal().array().log().sum();
    point.parameters = factor.solve(statistics.products * point.noise.cwiseInverse());
    point.root = factor.matrixU().solve(MatrixXd::Identity(information.rows(), information.cols()));
    point.covariance = point.root * point.root.transpose();
    point.slopes = statistics.products;
    point.residuals.resize(outputs);
    for (Index k = 0; k < outputs; ++k) {
        const MatrixXd& square = statistics.squares[static_cast<std::size_t>(k)];
        point.products.emplace_back(point.covariance * square);
        point.slopes.col(k) -= square * point.parameters;
        point.residuals[k] = statistics.output_squares[k] -
                             point.parameters.dot(statistics.products.col(k) + point.slopes.col(k));
    }
    return point;
}

/// tr(P A_k), the contribution of pi's uncertainty to the residuals; 0 if pi has no prior.
VectorXd uncertainty(const Point& point, PhysicsPrior prior) {
    VectorXd traces = VectorXd::Zero(point.noise.size());
    for (Index k = 0; prior != PhysicsPrior::none && k < traces.size(); ++k) {
        traces[k] = point.products[static_cast<std::size_t>(k)].trace();
    }
    return traces;
}

/// (P_cc + pi_c^2) / gamma_c^2.
VectorXd prior_use(const Point& point) {
    const auto size = point.prior.size();
    return (point.covariance.diagonal() + point.parameters.cwiseAbs2()).head(size).cwiseQuotient(point.prior);
}

double value_of(const LinearStatistics& statistics, PhysicsPrior prior, const Point& point) {
    const double noise =
        static_cast<double>(statistics.samples) * (2 * std::numbers::pi * point.noise).array().log().sum();
    const double fit = (statistics.output_squares - statistics.products.transpose() * point.parameters)
                           .cwiseQuotient(point.noise)
                           .sum();
    const double volume =
        prior == PhysicsPrior::none ? 0 : point.prior.array().log().sum() + point.log_determinant;
    return noise + fit + volume;
}

VectorXd gradient_of(const LinearStatistics& statistics, PhysicsPrior prior, const Point& point) {
    const Index outputs = outputs_of(statistics);
    const Index groups = prior_groups(statistics, prior);
    VectorXd gradient(outputs + groups);
    gradient.head(outputs) =
        static_cast<double>(statistics.samples) -
        ((point.residuals + uncertainty(point, prior)).cwiseQuotient(point.noise)).array();
    if (groups > 0) {
        gradient.tail(groups) = gathered((1 - prior_use(point).array()).matrix(), prior);
    }
    return gradient;
}

/// Second derivatives with respect to the outputs' variances.
MatrixXd noise_hessian(PhysicsPrior prior, const Point& point) {
    const Index outputs = point.noise.size();
    MatrixXd hessian = -2 * point.slopes.transpose() * point.covariance * point.slopes;
    for (Index k = 0; prior != PhysicsPrior::none && k < outputs; ++k) {
        for (Index l = 0; l < outputs; ++l) {
            const MatrixXd& other = point.products[static_cast<std::size_t>(l)];
            hessian(k, l) -=
                point.products[static_cast<std::size_t>(k)].cwiseProduct(other.transpose()).sum();
        }
    }
    const VectorXd precision = point.noise.cwiseInverse();
    hessian = precision.asDiagonal() * hessian * precision.asDiagonal();
    hessian.diagonal() += (point.residuals + uncertainty(point, prior)).cwiseProduct(precision);
    return hessian;
}

/// Rows: prior groups, columns: outputs.
MatrixXd mixed_hessian(PhysicsPrior prior, const Point& point) {
    const Index outputs = point.noise.size();
    MatrixXd mixed(point.prior.size(), outputs);
    for (Index k = 0; k < outputs; ++k) {
        const VectorXd spread =
            point.products[static_cast<std::size_t>(k)].cwiseProduct(point.covariance).rowwise().sum();
        const VectorXd shift = 2 * point.parameters.cwiseProduct(point.covariance * point.slopes.col(k));
        mixed.col(k) = (shift - spread).cwiseQuotient(point.prior) / point.noise[k];
    }
    return gathered(mixed, prior);
}

MatrixXd prior_hessian(PhysicsPrior prior, const Point& point) {
    MatrixXd hessian = -point.covariance.cwiseAbs2();
    hessian -= 2 * point.parameters.asDiagonal() * point.covariance * point.parameters.asDiagonal();
    const VectorXd precision = point.prior.cwiseInverse();
    hessian = precision.asDiagonal() * hessian * precision.asDiagonal();
    hessian.diagonal() += prior_use(point);
    return gathered(gathered(hessian, prior).transpose(), prior);
}

MatrixXd hessian_of(const LinearStatistics& statistics, PhysicsPrior prior, const Point& point) {
    const Index outputs = outputs_of(statistics);
    const Index groups = prior_groups(statistics, prior);
    MatrixXd hessian(outputs + groups, outputs + groups);
    hessian.topLeftCorner(outputs, outputs) = noise_hessian(prior, point);
    if (groups > 0) {
        hessian.bottomLeftCorner(groups, outputs) = mixed_hessian(prior, point);
        hessian.topRightCorner(outputs, groups) = hessian.bottomLeftCorner(groups, outputs).transpose();
        hessian.bottomRightCorner(groups, groups) = prior_hessian(prior, point);
    }
    return hessian;
}

} // namespace

Index prior_groups(const LinearStatistics& statistics, PhysicsPrior prior) {
    switch (prior) {
    case PhysicsPrior::none:
        return 0;
    case PhysicsPrior::shared:
        return 1;
    default:
        return columns_of(statistics);
    }
}

VectorXd spread_prior(const LinearStatistics& statistics, PhysicsPrior prior, const VectorXd& x) {
    const Index groups = prior_groups(statistics, prior);
    const VectorXd variances = x.tail(groups).array().exp();
    return groups == 1 ? VectorXd::Constant(columns_of(statistics), variances[0]) : variances;
}

std::optional<VarianceCriterion> variance_criterion(const LinearStatistics& statistics, PhysicsPrior prior,
                                                    const VectorXd& x) {
    const auto point = point_at(statistics, prior, x);
    if (!point) {
        return std::nullopt;
    }
    VarianceCriterion criterion{value_of(statistics, prior, *point), gradient_of(statistics, prior, *point),
                                hessian_of(statistics, prior, *point), point->parameters, point->root};
    if (!std::isfinite(criterion.value) || !criterion.hessian.allFinite()) {
        return std::nullopt;
    }
    return criterion;
}

} // namespace dfdyn::tools
