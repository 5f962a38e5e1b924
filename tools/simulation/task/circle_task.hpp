// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/task/inverse_kinematics.hpp"
#include "tools/simulation/task/slow_variation.hpp"
#include "tools/simulation/task/task.hpp"

#include <array>
#include <vector>

namespace dfdyn::tools {

/// Follows the circle as a Cartesian controller does: integrates joint velocities from the inverse kinematics
/// at the current posture, with feedback of the tip's error.
class Circle final : public Task {
  public:
    Circle(const CircleTask& model, const Robot& robot, double period_s, std::uint64_t seed);
    Reference next() override;

  private:
    Eigen::Vector3d point(double angle) const;
    Eigen::Vector3d tangent(double angle) const;
    void check_reach();
    void wander();
    JointVector joint_velocity();

    CircleTask model_;
    double period_s_;
    InverseKinematics kinematics_;
    NormalSource source_;
    SlowVariation speed_;
    std::array<SlowVariation, 3> centre_;
    std::vector<SlowVariation> posture_;
    JointVector position_, velocity_, acceleration_;
    double angle_ = 0, angle_rate_ = 0;
    long step_ = 0;
};

} // namespace dfdyn::tools
