// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/arm/joint_loads.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

double Contact::pulse(double time_s) const {
    if (time_s <= start_s || time_s >= end_s) {
        return 0;
    }
    const double wave = std::sin(std::numbers::pi * (time_s - start_s) / (end_s - start_s));
    return wave * wave;
}

JointVector JointLoads::torque(const JointVector& position, const JointVector& velocity,
                               double time_s) const {
    JointVector result = JointVector::Zero(position.size());
    if (springs) {
        result += springs->stiffness.cwiseProduct(springs->rest - position);
    }
    if (ripple) {
        const JointVector angle = ripple->cycles.cwiseProduct(position) + ripple->phase;
        result -= ripple->amplitude.cwiseProduct(angle.array().sin().matrix());
    }
    for (const Contact& contact : contacts) {
        if (contact.joint) {
            result[*contact.joint] += contact.peak * contact.pulse(time_s);
        }
    }
    if (further) {
        result += further(position, velocity);
    }
    return result;
}

Eigen::Vector3d JointLoads::tip_force(double time_s) const {
    Eigen::Vector3d result = Eigen::Vector3d::Zero();
    for (const Contact& contact : contacts) {
        result += contact.pulse(time_s) * contact.force;
    }
    return result;
}

} // namespace dfdyn::tools
