// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

#include <vector>

namespace dfdyn::tools {

/// Parameters of the robot's estimation of velocity and acceleration from its encoders: see
/// dfdyn::AdaptiveWindow.
struct DerivativeModel {
    double rate_hz = 1000;        ///< rate of the readings in use
    int velocity_window = 16;     ///< readings, maximum
    int acceleration_window = 25; ///< readings, maximum
    double noise_bound = 0;       ///< rad: largest deviation of a fit from a reading
};

/// Estimates velocity and acceleration of every joint from the last readings of its encoder. While a window
/// is not full, it uses the available readings; it returns 0 if they are too few for a fit.
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
    std::vector<double> time_;  ///< of the readings, newest first
    std::vector<double> value_; ///< longest_ per joint, newest first
};

} // namespace dfdyn::tools
