// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/simulation/task/inverse_kinematics.hpp"
#include "tools/simulation/task/task.hpp"

#include <array>
#include <vector>

namespace dfdyn::tools {

/// A slow and smooth random signal: white noise through two equal low-pass filters, so that its rate is
/// continuous. It starts at 0; after a few time constants its standard deviation is `size`.
class SlowVariation {
  public:
    SlowVariation(double size, double time_constant_s, double period_s);

    /// Advances by one step of `period_s`.
    void advance(NormalSource& source);

    double value() const noexcept { return value_; }
    double rate() const noexcept { return rate_; } ///< per second

  private:
    double size_;
    double left_; ///< decay factor of a low-pass filter's state per step
    double period_s_;
    double first_ = 0, second_ = 0;
    double value_ = 0, rate_ = 0;
};

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
