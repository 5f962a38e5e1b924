// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/inertia.hpp"

#include "tools/base/text/number.hpp"

#include <Eigen/Eigenvalues>

namespace dfdyn::tools {

namespace {

/// Relative; inertias in files have about six digits.
constexpr double rounding = 1e-6;

/// The linear map between an inertia and the second moments about the same point. It is its own inverse up to
/// a factor: Σ = tr(I)/2 − I, I = tr(Σ) − Σ.
Eigen::Matrix3d trace_minus(const Eigen::Matrix3d& matrix, double factor) {
    return factor * matrix.trace() * Eigen::Matrix3d::Identity() - matrix;
}

Eigen::Matrix3d symmetric(const Eigen::Matrix<double, 6, 1>& values) {
    Eigen::Matrix3d matrix;
    matrix << values[0], values[1], values[2], values[1], values[3], values[4], values[2], values[4],
        values[5];
    return matrix;
}

} // namespace

InertialParameters body_parameters(double mass, const Eigen::Vector3d& centre,
                                   const Eigen::Matrix3d& inertia_about_centre) {
    Eigen::Matrix4d moments;
    moments.topLeftCorner<3, 3>() =
        trace_minus(inertia_about_centre, 0.5) + mass * centre * centre.transpose();
    moments.topRightCorner<3, 1>() = mass * centre;
    moments.bottomLeftCorner<1, 3>() = mass * centre.transpose();
    moments(3, 3) = mass;
    return parameters_of(moments);
}

CentralBody central_body(const InertialParameters& parameters) {
    CentralBody body;
    body.mass = parameters[0];
    if (body.mass > 0) {
        body.centre = parameters.segment<3>(1) / body.mass;
    }
    body.inertia = symmetric(parameters.tail<6>()) -
                   body.mass * (body.centre.squaredNorm() * Eigen::Matrix3d::Identity() -
                                body.centre * body.centre.transpose());
    return body;
}

CentralInertia central_inertia(const InertialParameters& parameters) {
    const Eigen::Matrix3d inertia = central_body(parameters).inertia;
    return {inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2)};
}

Eigen::Matrix4d pseudo_inertia(const InertialParameters& parameters) {
    Eigen::Matrix4d moments;
    moments.topLeftCorner<3, 3>() = trace_minus(symmetric(parameters.tail<6>()), 0.5);
    moments.topRightCorner<3, 1>() = parameters.segment<3>(1);
    moments.bottomLeftCorner<1, 3>() = parameters.segment<3>(1).transpose();
    moments(3, 3) = parameters[0];
    return moments;
}

InertialParameters parameters_of(const Eigen::Matrix4d& pseudo_inertia) {
    const Eigen::Matrix3d inertia = trace_minus(pseudo_inertia.topLeftCorner<3, 3>(), 1.0);
    InertialParameters parameters;
    parameters << pseudo_inertia(3, 3), pseudo_inertia.topRightCorner<3, 1>(), inertia(0, 0), inertia(0, 1),
        inertia(0, 2), inertia(1, 1), inertia(1, 2), inertia(2, 2);
    return parameters;
}

InertialParameters moved(const InertialParameters& parameters, const Eigen::Isometry3d& placement) {
    return parameters_of(placement.matrix() * pseudo_inertia(parameters) * placement.matrix().transpose());
}

std::optional<std::string> inertia_fault(const InertialParameters& parameters) {
    if (parameters.isZero(0)) {
        return std::nullopt;
    }
    if (!(parameters[0] > 0)) {
        return "mass " + number_text(parameters[0]) + " kg is not positive";
    }
    const Eigen::Matrix3d moments = trace_minus(central_body(parameters).inertia, 0.5);
    const Eigen::Vector3d principal =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments, Eigen::EigenvaluesOnly).eigenvalues();
    const double tolerance = rounding * pseudo_inertia(parameters).topLeftCorner<3, 3>().trace();
    if (principal[0] >= -std::abs(tolerance)) {
        return std::nullopt;
    }
    // A principal inertia is the sum of two principal second moments; the smallest one uses the two smallest.
    return principal[0] + principal[1] < 0
               ? "its inertia about the centre of mass is not positive"
               : "one of its principal inertias is larger than the sum of the other two";
}

} // namespace dfdyn::tools
