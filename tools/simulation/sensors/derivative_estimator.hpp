// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

#include <vector>

namespace dfdyn::tools {

/// How the robot estimates velocity and acceleration from its encoders: see dfdyn::AdaptiveWindow.
struct DerivativeModel {
    double rate_hz = 1000;        ///< of the readings that it looks at
    int velocity_window = 16;     ///< readings, at most
    int acceleration_window = 25; ///< readings, at most
    double noise_bound = 0;       ///< rad: how far a fit may miss a reading
};

/// Velocity and acceleration of every joint from the last readings of its encoder. Fewer readings than a
/// window holds: from those there are; with fewer than the fit needs, 0.
class DerivativeEstimator {
  public:
    DerivativeEstimator(const DerivativeModel& model, int joint_count, double period_s);

    void observe(const JointVector& reading);
    JointVector velocity() const;     ///< rad/s
    JointVector acceleration() const; ///< rad/s²

  private:
    DerivativeModel model_;
    int joint_count_;
    int longest_;
    int held_ = 0;
    std::vector<double> time_;  ///< of the readings, newest (0) first
    std::vector<double> value_; ///< longest_ per joint, newest first
};

} // namespace dfdyn::tools
