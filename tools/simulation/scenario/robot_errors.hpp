// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"

#include <cstddef>
#include <vector>

namespace dfdyn::tools {

/// How a link differs from its description: the real one minus the described one. The mass sits at the
/// described centre of mass; then the whole link's mass is shifted, and spread.
struct LinkError {
    std::size_t joint = 0;                                  ///< that moves the link, from 0
    double delta_mass = 0;                                  ///< kg
    Eigen::Vector3d delta_centre = Eigen::Vector3d::Zero(); ///< m, in the link's frame
    /// kg·m²: of the moments of inertia xx, yy and zz about the centre of mass, along the link's axes.
    Eigen::Vector3d delta_inertia = Eigen::Vector3d::Zero();
};

/// How a robot differs from its description.
struct RobotErrors {
    std::vector<LinkError> links;
    double tilt_x = 0,
           tilt_y = 0; ///< rad: the base is turned by tilt_x, then by tilt_y, about the root's axes
};

/// The robot that `described` really is. A F/T sensor within a link with an error measures the whole of it,
/// not the part at its own side only: `delta_mass`, shift and `delta_inertia` count beyond it as far as that
/// part's share of the mass. Throws InputError where a link's mass would not stay positive, or no body has
/// such an inertia.
Robot real_robot(Robot described, const RobotErrors& errors);

} // namespace dfdyn::tools
