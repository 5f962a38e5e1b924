// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/identification/log_cholesky.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double least_radius = 1e-3; ///< m

/// U without the factor e^α.
Eigen::Matrix4d factor(const LogCholesky& c) {
    Eigen::Matrix4d u;
    u << std::exp(c[1]), c[4], c[6], c[7], 0, std::exp(c[2]), c[5], c[8], 0, 0, std::exp(c[3]), c[9], 0, 0, 0,
        1;
    return u;
}

/// Row and column of each coordinate in U, from the second on.
constexpr int place[9][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

} // namespace

InertialParameters parameters_from(const LogCholesky& coordinates) {
    const Eigen::Matrix4d u = factor(coordinates);
    return parameters_of(std::exp(2 * coordinates[0]) * u * u.transpose());
}

Eigen::Matrix<double, 10, 10> parameters_slope(const LogCholesky& coordinates) {
    const Eigen::Matrix4d u = factor(coordinates);
    const double scale = std::exp(2 * coordinates[0]);
    Eigen::Matrix<double, 10, 10> slope;
    slope.col(0) = 2 * parameters_from(coordinates);
    for (int j = 1; j < 10; ++j) {
        const auto [row, column] = place[j - 1];
        const double change = row == column ? u(row, row) : 1.0;
        Eigen::Matrix4d half = Eigen::Matrix4d::Zero();
        half.row(row) = change * u.col(column).transpose();
        slope.col(j) = parameters_of(scale * (half + half.transpose()));
    }
    return slope;
}

LogCholesky coordinates_of(const InertialParameters& parameters) {
    // J = U Uᵀ with an upper triangular U is the Cholesky factorization of J with reversed order.
    const Eigen::Matrix4d reversed = pseudo_inertia(parameters).reverse();
    Eigen::Matrix4d u = reversed.llt().matrixL().toDenseMatrix().reverse();
    LogCholesky c;
    c[0] = std::log(u(3, 3));
    u /= u(3, 3);
    for (int j = 1; j < 10; ++j) {
        const auto [row, column] = place[j - 1];
        c[j] = row == column ? std::log(u(row, row)) : u(row, column);
    }
    return c;
}

bool is_consistent(const InertialParameters& parameters) {
    const Eigen::Matrix4d moments = pseudo_inertia(parameters);
    return parameters.allFinite() && moments.llt().info() == Eigen::Success;
}

InertialParameters made_consistent(const InertialParameters& parameters, double least_mass) {
    if (is_consistent(parameters)) {
        return parameters;
    }
    const double mass = std::max(parameters[0], least_mass);
    const Eigen::Vector3d centre = parameters[0] > least_mass
                                       ? Eigen::Vector3d(parameters.segment<3>(1) / mass)
                                       : Eigen::Vector3d::Zero();
    Eigen::Matrix4d moments = pseudo_inertia(parameters);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.topLeftCorner<3, 3>() -
                                                                mass * centre * centre.transpose());
    const Eigen::Vector3d principal = solver.eigenvalues().cwiseMax(mass * least_radius * least_radius);
    moments.topLeftCorner<3, 3>() =
        solver.eigenvectors() * principal.asDiagonal() * solver.eigenvectors().transpose() +
        mass * centre * centre.transpose();
    moments.topRightCorner<3, 1>() = mass * centre;
    moments.bottomLeftCorner<1, 3>() = mass * centre.transpose();
    moments(3, 3) = mass;
    return parameters_of(moments);
}

} // namespace dfdyn::tools
