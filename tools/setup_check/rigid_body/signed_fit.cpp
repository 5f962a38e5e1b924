// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/rigid_body/signed_fit.hpp"

#include "tools/base/numerics/linear_algebra.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double dependent = 1e-6; ///< share of a column's norm

MatrixXd centred(const MatrixXd& columns) { return columns.rowwise() - columns.colwise().mean(); }

std::vector<Index> positive_of(const VectorXd& x) {
    std::vector<Index> result;
    for (Index i = 0; i < x.size(); ++i) {
        if (x[i] > 0) {
            result.push_back(i);
        }
    }
    return result;
}

/// Moves `x` towards the unconstrained solution on `support` until it is reached or a coefficient becomes 0.
/// Returns the remaining support; `reached` if all of it is positive there.
std::vector<Index> step_to_solution(const MatrixXd& gram, const VectorXd& product, VectorXd& x,
                                    const std::vector<Index>& support, bool& reached) {
    const VectorXd solution = solve_symmetric(MatrixXd(gram(support, support)), VectorXd(product(support)));
    double step = 1;
    std::size_t limiting = support.size();
    for (std::size_t i = 0; i < support.size(); ++i) {
        const double now = x[support[i]];
        const double next = solution[static_cast<Index>(i)];
        if (!(next > 0) && now / (now - next) < step) {
            step = now / (now - next);
            limiting = i;
        }
    }
    for (std::size_t i = 0; i < support.size(); ++i) {
        double& value = x[support[i]];
        value = i == limiting ? 0 : std::max(0.0, value + step * (solution[static_cast<Index>(i)] - value));
    }
    reached = limiting == support.size();
    return positive_of(x);
}

/// Nonnegative minimizer of x' gram x / 2 - product' x for a gram matrix with a unit diagonal.
VectorXd nonnegative_minimizer(const MatrixXd& gram, const VectorXd& product) {
    constexpr double convergence = 1e-9;
    VectorXd x = VectorXd::Zero(product.size());
    for (Index round = 0; round < 5 * product.size(); ++round) {
        VectorXd slope = product - gram * x;
        for (const Index i : positive_of(x)) {
            slope[i] = 0;
        }
        Index steepest = 0;
        if (!(slope.maxCoeff(&steepest) > convergence * product.cwiseAbs().maxCoeff())) {
            break;
        }
        std::vector<Index> support = positive_of(x);
        support.push_back(steepest);
        for (bool reached = false; !reached && !support.empty();) {
            support = step_to_solution(gram, product, x, support, reached);
        }
    }
    return x;
}

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
    constexpr double ridge = 1e-9; // columns may be combinations of each other
    SignedFit result{1, VectorXd::Zero(not_negative.cols())};
    const double variance = centred(output).squaredNorm();
    if (!(std::sqrt(variance) > dependent * output.norm())) {
        return result;
    }
    MatrixXd columns(output.size(), not_negative.cols() + 1);
    columns.leftCols(not_negative.cols()) = not_negative;
    columns.rightCols<1>() = output;
    columns = left_of_columns(columns, free);
    const VectorXd target = columns.rightCols<1>();
    result.left = target.squaredNorm() / variance;
    std::vector<Index> usable;
    std::vector<double> norms;
    for (Index column = 0; column < not_negative.cols(); ++column) {
        const double norm = columns.col(column).norm();
        if (norm > dependent * not_negative.col(column).norm()) {
            columns.col(column) /= norm;
            usable.push_back(column);
            norms.push_back(norm);
        }
    }
    if (usable.empty()) {
        return result;
    }
    const MatrixXd used = columns(Eigen::all, usable);
    const auto count = static_cast<Index>(usable.size());
    const VectorXd found = nonnegative_minimizer(
        used.transpose() * used + ridge * MatrixXd::Identity(count, count), used.transpose() * target);
    result.left = (target - used * found).squaredNorm() / variance;
    for (Index i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        result.coefficients[usable[at]] = found[i] / norms[at];
    }
    return result;
}

} // namespace dfdyn::tools
