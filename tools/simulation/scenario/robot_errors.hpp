// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"

#include <cstddef>
#include <vector>

namespace dfdyn::tools {

/// Deviation of a link from its description: actual minus described. The additional mass is at the described
/// centre of mass. Then the centre and the inertia of the whole link are changed.
struct LinkError {
    std::size_t joint = 0; ///< index of the joint that moves the link, from 0
    double delta_mass = 0; ///< kg
    Eigen::Vector3d delta_centre = Eigen::Vector3d::Zero(); ///< m, in the link's frame
    /// kg·m²: change of the moments of inertia xx, yy and zz about the centre of mass, along the link's axes.
    Eigen::Vector3d delta_inertia = Eigen::Vector3d::Zero();
};

/// Deviation of a robot from its description.
struct RobotErrors {
    std::vector<LinkError> links;
    double tilt_x = 0,
           tilt_y = 0; ///< rad: the base is turned by tilt_x, then by tilt_y, about the root's axes
};

/// Returns the actual robot for the description `described`. An F/T sensor within such a link affects how the
/// errors are divided: `delta_mass`, shift and `delta_inertia` act beyond the sensor in proportion to the
/// mass there. Throws InputError if a link's mass would not be positive, or if no body can have the inertia.
Robot real_robot(Robot described, const RobotErrors& errors);

} // namespace dfdyn::tools
