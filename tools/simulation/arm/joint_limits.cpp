// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/arm/joint_limits.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"

#include <cmath>
#include <cstdio>

namespace dfdyn::tools {

namespace {

std::string length_text(const RobotJoint& joint, double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text + std::string(joint.prismatic ? " m" : " rad");
}

[[noreturn]] void refuse(const RobotJoint& joint, double position, double limit, const std::string& name,
                         const std::string& where) {
    throw InputError(where + "joint " + joint.name + ": expected a position within its limits, found " +
                     length_text(joint, position) + ", " + length_text(joint, std::abs(position - limit)) +
                     " beyond its " + limit_text(joint, name, limit));
}

} // namespace

std::string limit_text(const RobotJoint& joint, const std::string& name, double limit) {
    return name + " limit " + length_text(joint, limit);
}

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

void check_stable(const JointVector& position, const JointVector& velocity, double time_s) {
    constexpr double runaway = 1e4; // rad/s
    if (!position.allFinite() || velocity.cwiseAbs().maxCoeff() > runaway) {
        throw InputError("t = " + number_text(time_s) +
                         " s: expected a stable simulation, found a diverging one: check gains, friction and "
                         "integration_rate_hz");
    }
}

} // namespace dfdyn::tools
