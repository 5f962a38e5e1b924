// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

namespace dfdyn::tools {

/// Elasticity and backlash between a joint's motor and its link, per joint. Joints with stiffness 0 are
/// rigid.
struct GearModel {
    JointVector stiffness; ///< N·m/rad, of the parts in contact
    JointVector damping;   ///< N·m·s/rad, of the parts in contact
    JointVector gap;       ///< rad, total backlash between the two contacts; 0: always in contact

    bool soft(Eigen::Index joint) const { return stiffness.size() > 0 && stiffness[joint] > 0; }

    /// Returns the number of coordinates of an arm with `joints` joints: two for each soft joint (motor and
    /// link), one for each rigid one.
    Eigen::Index coordinate_count(Eigen::Index joints) const;

    /// Returns the torque of the motor on the link if the motor leads by `twist` (rad) and `twist` grows by
    /// `rate` (rad/s). Parts with backlash push but never pull.
    double torque(Eigen::Index joint, double twist, double rate) const;
};

} // namespace dfdyn::tools
