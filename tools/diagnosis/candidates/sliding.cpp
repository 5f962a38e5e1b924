// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/sliding.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

JointSignals::JointSignals(const DiagnosisSignals& signals, std::size_t joint)
    : all(signals), where(place_text(PlaceKind::joint, joint)), output(static_cast<Eigen::Index>(joint)),
      position(signals.measured.motion.position.col(output)),
      velocity(signals.measured.motion.velocity.col(output)), direction(signals.direction(output)) {}

Eigen::VectorXd dahl(const JointSignals& joint, double distance, const Eigen::VectorXd& level) {
    constexpr double least = 1e-9; // avoids a division by zero
    Eigen::VectorXd friction(joint.position.size());
    for (const Stretch& stretch : joint.all.measured.stretches) {
        double state = 0;
        friction[stretch.first] = 0;
        for (Eigen::Index row = stretch.first + 1; row < stretch.first + stretch.count; ++row) {
            const double step = joint.position[row] - joint.position[row - 1];
            const double highest = std::max(level[row], least);
            const double settled = std::copysign(highest, step);
            state = settled + (state - settled) * std::exp(-std::abs(step) / (distance * highest));
            friction[row] = state;
        }
    }
    return friction;
}

Eigen::VectorXd dahl(const JointSignals& joint, double distance) {
    return dahl(joint, distance, Eigen::VectorXd::Ones(joint.position.size()));
}

std::vector<Eigen::VectorXd> sliding_directions(const JointSignals& joint) {
    return {joint.direction, dahl(joint, shortest_presliding / 8), dahl(joint, shortest_presliding / 3)};
}

} // namespace dfdyn::tools
