// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include <optional>
#include <string>

namespace dfdyn::tools {

/// Mass, first moment m·c (3) and inertia about the frame's origin (xx xy xz yy yz zz), in kg, kg·m, kg·m².
using InertialParameters = Eigen::Matrix<double, 10, 1>;

/// From mass (kg), centre of mass (m) and inertia about it (kg·m²), all in the same axes.
InertialParameters body_parameters(double mass, const Eigen::Vector3d& centre,
                                   const Eigen::Matrix3d& inertia_about_centre);

/// A body by mass (kg), centre of mass (m) and inertia about it (kg·m²), in its link's frame.
struct CentralBody {
    double mass = 0;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

/// Returns the body of these parameters. Its centre is the link's origin if it has no mass.
CentralBody central_body(const InertialParameters& parameters);

/// Moments and products of inertia about the centre of mass: xx yy zz xy xz yz, kg·m².
using CentralInertia = Eigen::Matrix<double, 6, 1>;
CentralInertia central_inertia(const InertialParameters& parameters);

/// Returns the second moments of the mass distribution, as a 4x4 matrix linear in the parameters: the
/// integral of (x, 1) (x, 1)ᵀ dm. A body can have these parameters if and only if it is positive definite
/// (semidefinite for bodies without volume). A positive mass and the triangle inequality of the principal
/// inertias follow.
Eigen::Matrix4d pseudo_inertia(const InertialParameters& parameters);

/// Returns the inverse of `pseudo_inertia`.
InertialParameters parameters_of(const Eigen::Matrix4d& pseudo_inertia);

/// Returns the same body in an outer frame; `placement` is the pose of the body's own frame in it.
InertialParameters moved(const InertialParameters& parameters, const Eigen::Isometry3d& placement);

/// Returns why no body can have these parameters, as text after the body's name (`mass -1 kg is not
/// positive`), or nothing if a body can. Zero mass and inertia are accepted, and so is a body without volume,
/// within rounding.
std::optional<std::string> inertia_fault(const InertialParameters& parameters);

} // namespace dfdyn::tools
