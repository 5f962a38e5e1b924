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

/// Second moments of the mass distribution, as a 4x4 matrix linear in the parameters: the integral of
/// (x, 1) (x, 1)ᵀ dm. A body can have these parameters exactly when it is positive definite (semidefinite for
/// bodies without volume); mass > 0 and the triangle inequality of the principal inertias follow.
Eigen::Matrix4d pseudo_inertia(const InertialParameters& parameters);

/// The inverse of `pseudo_inertia`.
InertialParameters parameters_of(const Eigen::Matrix4d& pseudo_inertia);

/// The same body seen from an outer frame in which its own frame sits at `placement`.
InertialParameters moved(const InertialParameters& parameters, const Eigen::Isometry3d& placement);

/// What no body can have, in words that go after the body's name (`mass -1 kg is not positive`); nothing when
/// a body can. Zero mass and inertia are no fault; nor is a body without volume, up to rounding.
std::optional<std::string> inertia_fault(const InertialParameters& parameters);

} // namespace dfdyn::tools
