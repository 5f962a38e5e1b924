// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/arm/gear.hpp"

#include <algorithm>

namespace dfdyn::tools {

Eigen::Index GearModel::coordinate_count(Eigen::Index joints) const {
    Eigen::Index count = joints;
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
        count += soft(joint) ? 1 : 0;
    }
    return count;
}

double GearModel::torque(Eigen::Index joint, double twist, double rate) const {
    const double half = gap[joint] / 2;
    const double pressed = twist - std::clamp(twist, -half, half);
    const double torque = stiffness[joint] * pressed + damping[joint] * rate;
    if (half == 0) {
        return torque;
    }
    if (pressed == 0) {
        return 0;
    }
    return pressed > 0 ? std::max(0.0, torque) : std::min(0.0, torque);
}

} // namespace dfdyn::tools
