// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/joint_limits.hpp"

#include "tools/common/error.hpp"

#include <cmath>
#include <cstdio>
#include <string_view>

namespace dfdyn::tools {

namespace {

std::string rounded(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

[[noreturn]] void refuse(const RobotJoint& joint, double position, double limit, std::string_view name,
                         const std::string& where) {
    const std::string unit = joint.prismatic ? " m" : " rad";
    throw InputError(where + "joint " + joint.name + ": expected a position within its limits, found " +
                     rounded(position) + unit + ", " + rounded(std::abs(position - limit)) + unit +
                     " beyond its " + std::string(name) + " limit " + rounded(limit) + unit);
}

} // namespace

void check_limits(const Robot& robot, const JointVector& position, const std::string& where) {
    for (Eigen::Index i = 0; i < position.size(); ++i) {
        const RobotJoint& joint = robot.joints[static_cast<std::size_t>(i)];
        if (joint.lower && position[i] < *joint.lower) {
            refuse(joint, position[i], *joint.lower, "lower", where);
        }
        if (joint.upper && position[i] > *joint.upper) {
            refuse(joint, position[i], *joint.upper, "upper", where);
        }
    }
}

} // namespace dfdyn::tools
