// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/sensors/derivative_estimator.hpp"
#include "tools/simulation/task/task.hpp"

#include <cstdint>
#include <vector>

namespace dfdyn::tools {

struct FeedbackGains {
    JointVector position; ///< N·m/rad
    JointVector velocity; ///< N·m·s/rad
};

/// What a joint can do; a reading beyond it is not that of a regular tick. Empty: not known.
struct MotionBounds {
    JointVector speed;        ///< rad/s, per joint
    JointVector acceleration; ///< rad/s², per joint
};

/// Proportional and derivative feedback of the joints' positions, tick by tick. Every reading has its own
/// tick. The velocity is that of the same readings at their own instants, by the adaptive window
/// (dfdyn::AdaptiveWindow: the longest line, of at most `velocity_window` readings, that misses none of them
/// by more than `noise_bound`), so the velocity over a gap is that over the gap. The reference's velocity is
/// taken over the same window: compared with that of now, the readings' delay would act as an inertia.
///
/// A joint without a reading of this tick coasts on its tracking error: the arm goes on along the reference
/// with the error that it had, and the error's rate, bounded by the joint's speed, falls linearly to 0
/// within `fade_ticks`. A reading of an earlier tick is extrapolated in the same way. So the feedback's
/// torque stays where it was, and does not follow from the age of a reading. A reading where no acceleration
/// within the bounds can have brought the joint restarts its window; the velocity is kept until the next.
///
/// No heap after construction; O(velocity_window²) per joint and reading at most.
class PositionFeedback {
  public:
    static constexpr int fade_ticks = 10;

    PositionFeedback(FeedbackGains gains, const DerivativeModel& filter, double period_s,
                     MotionBounds bounds = {});

    /// The next tick begins.
    void advance() noexcept { ++tick_; }

    /// Takes the reading of `ticks_ago` ticks before this one, at least 0, and the reference of that tick.
    /// `missing`: joints without a reading; null for none. A joint's reading that is not later than its last
    /// one changes nothing.
    void observe(int ticks_ago, const JointVector& position, const Reference& reference,
                 const std::vector<bool>* missing = nullptr);

    /// N·m.
    JointVector torque() const;

    /// Reference minus position at this tick, rad: measured, or coasted on.
    JointVector error() const;
    /// How fast that changes, rad/s.
    JointVector error_rate() const;

    /// Last readings; empty before the first of all joints.
    const JointVector& position() const noexcept { return position_; }
    /// At the last readings, rad/s.
    const JointVector& velocity() const noexcept { return velocity_; }
    /// Ticks since the last reading of `joint`.
    std::int64_t age(Eigen::Index joint) const noexcept {
        return tick_ - newest_tick_[static_cast<std::size_t>(joint)];
    }
    /// Whether this tick brought a reading of every joint.
    bool complete() const noexcept;
    /// Whether it did, each of the tick after the joint's last one, and where the joint's acceleration can
    /// have brought it.
    bool regular() const noexcept;

    const FeedbackGains& gains() const noexcept { return gains_; }

  private:
    void push(Eigen::Index joint, std::int64_t tick, double position, double reference);
    bool plausible(Eigen::Index joint, std::int64_t tick, double position,
                   const Reference& reference) const noexcept;
    /// Error and its rate at `tick`, from the last reading of a joint.
    double error_at(Eigen::Index joint, std::int64_t tick) const noexcept;
    double rate_at(Eigen::Index joint, std::int64_t tick) const noexcept;
    /// At the last reading, at most the joint's speed.
    double bounded_rate(Eigen::Index joint) const noexcept;

    FeedbackGains gains_;
    DerivativeModel filter_;
    double period_s_;
    MotionBounds bounds_;
    std::int64_t tick_ = 0;
    int window_;
    std::vector<std::int64_t> reading_tick_;   ///< window_ per joint, newest first
    std::vector<double> reading_;              ///< likewise
    std::vector<double> reference_;            ///< of the same instants
    std::vector<double> time_;                 ///< of one joint's readings, relative to the newest
    std::vector<int> held_;                    ///< readings, per joint
    std::vector<std::int64_t> newest_tick_;    ///< of the last reading, per joint
    std::vector<std::int64_t> observed_tick_;  ///< that brought it
    std::vector<bool> regular_;                ///< whether the last reading followed on the one before
    JointVector newest_, position_, velocity_; ///< at the last readings
    JointVector reading_error_, reading_rate_; ///< reference minus reading, and its rate, at them
};

} // namespace dfdyn::tools
