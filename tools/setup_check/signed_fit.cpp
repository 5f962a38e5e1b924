// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/signed_fit.hpp"

#include "tools/base/numerics/linear_algebra.hpp"

#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double dependent = 1e-6; ///< share of a column's norm

MatrixXd centred(const MatrixXd& columns) { return columns.rowwise() - columns.colwise().mean(); }

} // namespace

MatrixXd left_of_columns(const MatrixXd& columns, const MatrixXd& free) {
    MatrixXd basis(free.rows(), 0); // Gram-Schmidt, twice for accuracy
    for (Index column = 0; column < free.cols(); ++column) {
        VectorXd one = free.col(column).array() - free.col(column).mean();
        for (int pass = 0; pass < 2; ++pass) {
            one -= basis * (basis.transpose() * one);
        }
        if (one.norm() > dependent * free.col(column).norm()) {
            basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
            basis.rightCols<1>() = one.normalized();
        }
    }
    MatrixXd left = centred(columns);
    for (int pass = 0; pass < 2; ++pass) {
        left -= basis * (basis.transpose() * left);
    }
    return left;
}

SignedFit fit_signed(const VectorXd& output, const MatrixXd& free, const MatrixXd& not_negative) {
    SignedFit result{1, VectorXd::Zero(not_negative.cols())};
    const double variance = centred(output).squaredNorm();
    if (!(std::sqrt(variance) > dependent * output.norm())) {
        return result;
    }
    const MatrixXd columns = left_of_columns(not_negative, free);
    const VectorXd target = left_of_columns(output, free);
    result.left = target.squaredNorm() / variance;
    std::vector<Index> usable;
    for (Index column = 0; column < columns.cols(); ++column) {
        if (columns.col(column).norm() > dependent * not_negative.col(column).norm()) {
            usable.push_back(column);
        }
    }
    const MatrixXd gram = columns.transpose() * columns;
    const VectorXd product = columns.transpose() * target;
    for (unsigned subset = 1; subset < 1U << usable.size(); ++subset) {
        std::vector<Index> chosen;
        for (std::size_t i = 0; i < usable.size(); ++i) {
            if ((subset >> i & 1U) != 0) {
                chosen.push_back(usable[i]);
            }
        }
        const VectorXd scale = gram.diagonal()(chosen).cwiseSqrt().cwiseInverse();
        const MatrixXd scaled = scale.asDiagonal() * gram(chosen, chosen) * scale.asDiagonal();
        const VectorXd found =
            scale.asDiagonal() * solve_symmetric(scaled, VectorXd(scale.asDiagonal() * product(chosen)));
        if (!found.allFinite() || found.minCoeff() < 0) {
            continue;
        }
        const double left = (target - columns(Eigen::all, chosen) * found).squaredNorm() / variance;
        if (left < result.left) {
            result.left = left;
            result.coefficients.setZero();
            result.coefficients(chosen) = found;
        }
    }
    return result;
}

} // namespace dfdyn::tools
