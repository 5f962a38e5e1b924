// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/derivative_estimator.hpp"
#include "tools/simulation/task.hpp"

namespace dfdyn::tools {

struct FeedbackGains {
    JointVector position; ///< N·m/rad
    JointVector velocity; ///< N·m·s/rad
};

/// Proportional and derivative feedback of the joints' positions, tick by tick. The velocity is that of the
/// same positions, by the adaptive window (dfdyn::AdaptiveWindow: the longest line, of at most
/// `velocity_window` readings, that misses none of them by more than `noise_bound`). A tick without a reading
/// coasts: the position goes on at the last velocity. No heap after construction; O(velocity_window) per
/// joint and tick.
class PositionFeedback {
  public:
    PositionFeedback(FeedbackGains gains, const DerivativeModel& filter, double period_s);

    void observe(const JointVector& position);
    void coast();

    /// N·m; the reference's and the arm's position and velocity at the same instant.
    JointVector torque(const Reference& reference) const;

    /// Observed or coasted; empty before the first.
    const JointVector& position() const noexcept { return position_; }
    const JointVector& velocity() const noexcept { return velocity_; }

  private:
    FeedbackGains gains_;
    double period_s_;
    DerivativeEstimator filter_;
    JointVector position_, velocity_;
};

} // namespace dfdyn::tools
