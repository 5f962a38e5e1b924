// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

#include <vector>

namespace dfdyn::tools {

/// Root mean square of the tracking error over one time window.
struct TrackingWindow {
    double start_s = 0, end_s = 0;
    JointVector rms;     ///< per joint, rad
    double all = 0;      ///< over all joints
    JointVector learned; ///< mean share of the learned model in the feed-forward
};

/// Collects tracking errors window by window; the last one is left out if it is incomplete.
class Tracking {
  public:
    /// `window_s`: at least `period_s`, the time from one error to the next.
    Tracking(double window_s, double period_s) : window_s_(window_s), period_s_(period_s) {}

    /// `error`: reference minus true position, rad. Times must increase, starting at 0.
    void add(double time_s, const JointVector& error, const JointVector& learned_share);

    const std::vector<TrackingWindow>& windows() const noexcept { return windows_; }

  private:
    void close();

    double window_s_, period_s_;
    std::vector<TrackingWindow> windows_;
    JointVector squares_, shares_;
    long count_ = 0;
};

} // namespace dfdyn::tools
