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

/// Physical bounds of a joint. A reading beyond them does not belong to a regular tick. Empty: unknown.
struct MotionBounds {
    JointVector speed;        ///< rad/s, per joint
    JointVector acceleration; ///< rad/s², per joint
};

/// Proportional and derivative feedback of the joint positions, tick by tick. Every reading belongs to a
/// tick. The velocity is estimated by the adaptive window (dfdyn::AdaptiveWindow: the longest line through at
/// most `velocity_window` readings that deviates from none by more than `noise_bound`), with the readings'
/// own times. A bound below the encoder's count (the smallest step so far, at most four bounds unless the
/// bound is 0) is replaced by it: a line through a rounded reading deviates from another one by up to a
/// count, and without this a window would sometimes have only two readings. The velocity across a gap is
/// therefore the mean velocity over the gap. The reference's velocity is computed over the same window; with
/// the present reference velocity, the readings' delay would act as an inertia.
///
/// A joint without a reading in this tick is extrapolated by its tracking error: it follows the reference
/// with its last error. The error's rate, limited to the joint's speed, decreases linearly to 0 within
/// `fade_ticks`. A reading of an earlier tick is extrapolated in the same way. The feedback's torque
/// therefore stays continuous and does not depend on a reading's age. A reading that requires an acceleration
/// beyond the bounds restarts the joint's window, as does one that returns to the motion before it. The
/// velocity is kept until the next reading. Until the window is full, its change is limited by the
/// acceleration's bound, as far as the noise of the readings explains the rest.
///
/// No heap after construction; at most O(velocity_window²) per joint and reading.
class PositionFeedback {
  public:
    static constexpr int fade_ticks = 10;
    static constexpr int bridged_ticks = 2;
    /// readings in a row, that together need no impossible acceleration: then a jump is the joint's position
    static constexpr int settled_readings = 3;

    struct JointMotion {
        double position; ///< rad
        double velocity; ///< rad/s
    };

    PositionFeedback(FeedbackGains gains, const DerivativeModel& filter, double period_s,
                     MotionBounds bounds = {});

    /// Begins the next tick.
    void advance() noexcept { ++tick_; }

    /// Adds the reading of the tick `ticks_ago` (at least 0) before this one, and the reference of that tick.
    /// `missing`: joints without a reading; null for none. A reading that is not later than the joint's last
    /// one is ignored.
    void observe(int ticks_ago, const JointVector& position, const Reference& reference,
                 const std::vector<bool>* missing = nullptr);

    /// Adds `distance` to the references of the readings so far, so that a moved reference does not look like
    /// a jump of a reading.
    void move_reference(const JointVector& distance);

    /// From now on the reference rests at `reference`, rad: the readings so far count as readings beside it,
    /// so that a moving joint does not look like a jump.
    void hold_reference(const JointVector& reference);

    /// Returns the feedback torque, N·m.
    JointVector torque() const;

    /// Reference minus position at this tick, rad: measured or extrapolated.
    JointVector error() const;
    /// Rate of the error, rad/s.
    JointVector error_rate() const;

    /// Last readings; empty until every joint has one.
    const JointVector& position() const noexcept { return position_; }
    /// Velocity at the last readings, rad/s.
    const JointVector& velocity() const noexcept { return velocity_; }
    /// Returns the motion of `joint` at this tick, extrapolated from its last believed reading: the one
    /// before a jump that has not settled. The velocity is within the joint's speed bound.
    JointMotion believed_motion(Eigen::Index joint) const noexcept;
    /// Returns whether the last reading of `joint` is believed: no jump, or one with `settled_readings`.
    bool settled(Eigen::Index joint) const noexcept;
    /// Returns whether the readings of `joint` jumped and have not returned to the motion before.
    bool jumped(Eigen::Index joint) const noexcept {
        return restart_[static_cast<std::size_t>(joint)].jumped;
    }
    /// Smallest step between two successive readings of `joint` so far, rad: its encoder's count. 0: none.
    double smallest_step(Eigen::Index joint) const noexcept { return smallest_step_[joint]; }
    /// Noise bound that the filter was given, rad.
    double given_noise_bound() const noexcept { return filter_.noise_bound; }
    /// Noise bound of the window of `joint`, rad.
    double noise_bound(Eigen::Index joint) const noexcept;
    /// Ticks since the last reading of `joint`.
    std::int64_t age(Eigen::Index joint) const noexcept {
        return tick_ - newest_tick_[static_cast<std::size_t>(joint)];
    }
    /// Returns whether a reading of `joint` was added in this tick, of whatever age.
    bool observed(Eigen::Index joint) const noexcept {
        return tick_ == observed_tick_[static_cast<std::size_t>(joint)];
    }
    /// Returns the ticks since the last reading of the joint that has waited longest.
    int longest_silence() const noexcept;
    /// Returns the joint without a reading in this tick; none if there is not exactly one.
    std::optional<Eigen::Index> silent_joint() const noexcept;
    /// Returns whether the motion at this tick is known: every joint's last reading is within the bounds and
    /// was added at most `bridged_ticks` ago.
    bool known() const noexcept;
    /// Returns whether every joint has a reading of this tick.
    bool complete() const noexcept;
    /// Returns whether `joint` has a reading of this tick, one tick after its previous one and within the
    /// bounds.
    bool regular(Eigen::Index joint) const noexcept;
    /// Returns whether the tick is complete, each reading follows its joint's previous one by one tick, and
    /// all accelerations are within the bounds.
    bool regular() const noexcept;

    const FeedbackGains& gains() const noexcept { return gains_; }

  private:
    /// Last reading before the restart of a joint's window, and the motion at its time.
    struct Restart {
        std::int64_t tick = -1; ///< -1: none
        double position = 0;    ///< rad
        double velocity = 0;    ///< rad/s
        double error = 0;       ///< reference minus reading, rad
        double rate = 0;        ///< of the error, rad/s
        bool jumped = false;    ///< the readings have not returned to that motion
    };

    /// Restarts the window of `joint`. Its velocity is kept until there are two readings.
    void restart(Eigen::Index joint);
    void push(Eigen::Index joint, std::int64_t tick, double position, double reference);
    /// Limits a noisy velocity by the last one before the restart of a window that is not full yet.
    double reachable(Eigen::Index joint, std::int64_t tick, double velocity) const noexcept;
    bool plausible(Eigen::Index joint, std::int64_t tick, double position,
                   const Reference& reference) const noexcept;
    /// Returns whether `position` and the last two readings after a jump need no impossible acceleration.
    bool continues(Eigen::Index joint, std::int64_t tick, double position) const noexcept;
    /// Error and its rate at `tick`, extrapolated from a joint's last reading.
    double error_at(Eigen::Index joint, std::int64_t tick) const noexcept;
    double rate_at(Eigen::Index joint, std::int64_t tick) const noexcept;
    /// Error rate at the last reading, limited to the joint's speed.
    double bounded_rate(Eigen::Index joint) const noexcept;
    /// Returns `velocity`, rad/s, limited to the joint's speed.
    double within_speed(Eigen::Index joint, double velocity) const noexcept;

    FeedbackGains gains_;
    DerivativeModel filter_;
    double period_s_;
    MotionBounds bounds_;
    std::int64_t tick_ = 0;
    int window_;
    std::vector<std::int64_t> reading_tick_;  ///< window_ per joint, newest first
    std::vector<double> reading_;             ///< window_ per joint, newest first
    std::vector<double> reference_;           ///< at the times of the readings
    std::vector<double> time_;                ///< of one joint's readings, relative to the newest
    std::vector<int> held_;                   ///< number of readings, per joint
    std::vector<std::int64_t> newest_tick_;   ///< of the last reading, per joint
    std::vector<std::int64_t> observed_tick_; ///< tick in which it was added
    std::vector<bool> regular_;               ///< whether the last reading directly followed the previous one
    std::vector<bool> believed_;              ///< whether the last reading was within the bounds
    std::vector<Restart> restart_;            ///< last one of each joint's window
    JointVector newest_, position_, velocity_; ///< at the last readings
    JointVector smallest_step_;
    /// reference minus reading and its rate, at the last readings
    JointVector reading_error_, reading_rate_;
};

} // namespace dfdyn::tools
