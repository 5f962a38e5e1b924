// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/control/loop_margin.hpp"

#include <cmath>
#include <cstddef>
#include <deque>

namespace dfdyn::tests {

/// A joint with inertia only, under PD feedback about zero and an observer. Quasi-continuous, with negligibly
/// short steps: the reference for the tests of both.
class ServoJoint {
  public:
    explicit ServoJoint(const JointLoop<double>& loop, double step_s)
        : loop_(loop), step_s_(step_s), position_delay_(ticks(loop.delay_s) + 1),
          velocity_delay_(ticks(loop.delay_s + loop.velocity_delay_s) + 1) {}

    /// The controller's delayed measurement of the tracking error and its rate.
    [[nodiscard]] double error() const { return -position_delay_.front(); }
    [[nodiscard]] double error_rate() const { return -velocity_delay_.front(); }
    [[nodiscard]] double feedback() const {
        return loop_.position_gain * error() + loop_.velocity_gain * error_rate();
    }

    /// Applies a torque for one step.
    void advance(double torque) {
        velocity_ += step_s_ * torque / loop_.inertia;
        position_ += step_s_ * velocity_;
        position_delay_.push_back(position_);
        position_delay_.pop_front();
        velocity_delay_.push_back(velocity_);
        velocity_delay_.pop_front();
    }

    [[nodiscard]] double position() const { return position_; }

  private:
    [[nodiscard]] std::size_t ticks(double time_s) const {
        return static_cast<std::size_t>(std::lround(time_s / step_s_));
    }

    JointLoop<double> loop_;
    double step_s_;
    double position_ = 0, velocity_ = 0;
    std::deque<double> position_delay_, velocity_delay_;
};

} // namespace dfdyn::tests
