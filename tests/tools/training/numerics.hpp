// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include <cmath>
#include <limits>
#include <numbers>

namespace dfdyn::tests {

/// Gradient of `function` at `point` from fourth-order central differences.
template <class Function>
Eigen::VectorXd differences(const Function& function, const Eigen::VectorXd& point, double step = 1e-3) {
    Eigen::VectorXd gradient(point.size());
    for (Eigen::Index i = 0; i < point.size(); ++i) {
        const auto at = [&](double steps) {
            Eigen::VectorXd moved = point;
            moved[i] += steps * step;
            return function(moved);
        };
        gradient[i] = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * step);
    }
    return gradient;
}

/// Largest error of an element, relative to the element plus a thousandth of the largest element.
inline double relative_error(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected) {
    if (!found.allFinite()) {
        return std::numeric_limits<double>::infinity();
    }
    const double floor = 1e-3 * expected.cwiseAbs().maxCoeff();
    return ((found - expected).array().abs() / (expected.array().abs() + floor)).maxCoeff();
}

/// log N(y; 0, covariance) by the textbook formula with an explicit determinant.
inline double log_normal_density(const Eigen::VectorXd& y, const Eigen::MatrixXd& covariance) {
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(2 * std::numbers::pi * covariance);
    return -0.5 * std::log(lu.determinant()) - 0.5 * y.dot(covariance.partialPivLu().solve(y));
}

} // namespace dfdyn::tests
