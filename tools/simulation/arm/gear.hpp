// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

namespace dfdyn::tools {

/// What couples a joint's motor to its link, per joint. Joints whose stiffness is 0 are rigid.
struct GearModel {
    JointVector stiffness; ///< N·m/rad, of the parts in contact
    JointVector damping;   ///< N·m·s/rad, likewise
    JointVector gap;       ///< rad, the whole play between two contacts; 0: always in contact

    bool soft(Eigen::Index joint) const { return stiffness.size() > 0 && stiffness[joint] > 0; }

    /// What the motor exerts on the link when it is `twist` (rad) ahead, and that grows by `rate` (rad/s).
    /// Parts with play push, they never pull.
    double torque(Eigen::Index joint, double twist, double rate) const;
};

} // namespace dfdyn::tools
