// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/control/disturbance_observer.hpp"
#include "tools/control/loop/feed_forward.hpp"
#include "tools/control/loop/finding_actions.hpp"
#include "tools/control/loop/joint_watch.hpp"
#include "tools/control/loop/pausable_task.hpp"
#include "tools/control/loop/position_feedback.hpp"
#include "tools/control/loop/safe_stop.hpp"
#include "tools/control/loop/sample_clock.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace dfdyn::tools {

struct LoopConfig {
    double period_s = 0.001;
    int knot_ticks = 1;  ///< number of ticks per knot: the learned model's sample period
    int delay_ticks = 0; ///< number of ticks from a measurement to the tick that receives it
    FeedbackGains gains;
    DerivativeModel filter;   ///< filter that estimates the velocity
    JointVector torque_limit; ///< N·m, limit of every command
    JointVector bandwidth;    ///< disturbance observer's bandwidth, rad/s, per joint; 0: no observer
    SafeStopConfig safe_stop;
    FindingActions actions;                           ///< reactions to findings of the learner's monitor
    FindingAction on_contact = FindingAction::report; ///< reaction to a contact; report: none
};

/// Measurements and events of one tick.
struct LoopInput {
    /// Time of the measurement; ignored without a measurement. One measurement per tick is expected, one
    /// period after the previous one. For the treatment of others see SampleClock.
    std::int64_t time_ns = 0;
    const JointVector* position = nullptr;      ///< null: no valid position
    const JointVector* torque = nullptr;        ///< measured at the same time; null: no valid torque
    const std::vector<bool>* missing = nullptr; ///< joints without a measured position; null: none
    bool returning = false;                     ///< no position yet, from devices that send and still qualify
    bool deadline_missed = false;
    bool bus_lost = false;
    bool stop_requested = false;
};

struct LoopCounters {
    std::uint64_t ticks = 0;
    std::uint64_t running = 0; ///< ticks of these that followed the reference
    std::uint64_t coasted = 0; ///< running ticks without a reading of every joint
    std::uint64_t limited = 0; ///< running ticks with the torque of any joint at its limit
};

/// A joint-level control loop: feed-forward for the reference, feedback of the positions, limits, and a safe
/// stop. It is independent of the operating system and the bus; the caller schedules the ticks. One tick has
/// bounded cost, see FeedForward and PositionFeedback.
///
/// Running: the loop starts when the arm has positions and is within the following error of the reference's
/// beginning. If the position gain answered the distance by more than `recovery_step` of the torque limit,
/// the reference begins where the arm is, and PausableTask leads it in. The feed-forward uses times on the
/// loop's own grid and learns from the commands, so that a wrong torque sensor does not degrade the tracking.
/// The disturbance observer compensates the error of the feed-forward, at most `observer_share` of the torque
/// limit; noise of the readings changes it by about `observer_step` of the limit per tick at most. It holds
/// its value while positions are missing. A joint that it makes vibrate, by `vibration_swing` of the limit
/// from turn to turn, halves its bandwidth (dfdyn::VibrationWatch).
///
/// The torque of feedback and observer changes by at most `feedback_step` of the torque limit per tick: a
/// wrong reading that a joint could have reached makes no kick. After a tick that was not regular (see
/// PositionFeedback) it changes by at most `recovery_step`, which blends in the correction at the first
/// reading after a gap, until `recovery_ticks` successive regular ticks did not need it. A loop whose
/// commands change less keeps its gain and phase.
///
/// A contact (LoopConfig::on_contact) stops the motion on its path (PausableTask); the loop never resumes it
/// by itself. The command changes by at most a torque limit per `stop_time_s`. Its new value is the gravity
/// torque of the nominal body at the measured position, plus the compensated offsets. `hold` adds the torque
/// of the gains about the stopped reference. `yield` adds nothing during the contact, and the torque of the
/// velocity gain after it. Observer, learned torque and friction add nothing. `calm_s` after the end of the
/// contact the reference moves to the measured position. The arm holds there until the next contact. While it
/// yields there is no following error.
///
/// Stopping: every joint receives a reference that brakes from its present position and velocity to rest
/// within `stop_time_s`. The command changes, by at most a torque limit per `stop_time_s`, to the sum of
/// - the torque for this braking and against gravity, by the nominal rigid body and the learned part
///   (FeedForward::holding);
/// - the disturbance that the observer estimates until the brakes are requested, unless something blocked the
///   arm or a reading was wrong;
/// - the torque of the position and velocity gains, for joints with a believed reading in the last
///   `damping_ticks` ticks, for any cause. The position gain contributes at most `spring_share` of the torque
///   limit. Other joints are not damped and brake from their last believed motion; when their readings
///   return, or when a jump has settled, they brake from their position at that time.
///
/// The command is zero until the loop has moved the arm for the first time.
///
/// Brakes are requested at the first of these events:
/// - in `stopped`, no joint is faster than 0.05 rad/s (m/s);
/// - a joint cannot be damped;
/// - `brake_timeout_s` after `stopped`.
///
/// `brake_ticks` later the torque ends if the loop does: in StopMode::limp, after a requested stop, or after
/// `give_up_s` without a position. It goes to zero by at most a torque limit per `stop_time_s`, so that
/// drives that keep their last command keep no torque.
class ControlLoop {
  public:
    static constexpr double feedback_step = 0.1, recovery_step = 0.05;
    static constexpr double observer_share = 0.3;
    static constexpr double observer_step = 0.04;
    static constexpr double vibration_swing = 0.05;
    static constexpr int recovery_ticks = 10;
    static constexpr double stop_time_s = 0.1;
    static constexpr int damping_ticks = 5;
    static constexpr double spring_share = 0.5;
    static constexpr double brake_timeout_s = 1;
    static constexpr double give_up_s = 1;
    static constexpr double calm_s = 0.5;

    ControlLoop(LoopConfig config, FeedForward feed_forward, std::unique_ptr<Task> task);

    /// Computes the command until the next tick, N·m.
    const JointVector& tick(const LoopInput& input);

    LoopState state() const noexcept { return safe_stop_.state(); }
    StopCause cause() const noexcept { return safe_stop_.cause(); }
    /// Joint (from 0) that caused following_error, overspeed, torque_limit or frozen_encoder, or that alone
    /// caused no_position.
    std::optional<Eigen::Index> stopped_by() const noexcept { return safe_stop_.joint(); }
    /// Reactions to findings and contacts except `report`; the first 64, and the one that stops the loop.
    const std::vector<TakenAction>& actions() const noexcept { return actions_.list(); }
    /// Reaction that stops the loop; empty: none.
    const std::optional<TakenAction>& stopping_action() const noexcept { return actions_.stop(); }
    /// Returns whether the program should close the arm's brakes; stays true.
    bool brake_requested() const noexcept { return brake_tick_.has_value(); }
    /// Returns whether the torque ends or has ended in StopMode::limp: the brakes had time to close.
    bool limp() const noexcept;
    /// Returns whether the loop is finished: it has stopped, the requested brakes had `brake_ticks` to close,
    /// the command is zero, and one of these holds: a stop was requested (also after the loop stopped by
    /// itself), it is limp, or no positions have arrived for `give_up_s`.
    bool done() const noexcept;
    /// Returns whether the loop ends without a further request once the brakes had time to close.
    bool ends_itself() const noexcept { return told_ || config_.safe_stop.mode == StopMode::limp; }
    /// Reference of the last tick.
    const Reference& reference() const noexcept { return references_[tick_ % references_.size()]; }
    /// Reference minus position, measured at the last tick or extrapolated, rad, at the time of the
    /// measurement.
    const JointVector& error() const noexcept { return error_; }
    /// Observer's bandwidth, rad/s per joint; empty or 0: no observer.
    const JointVector& bandwidth() const noexcept { return config_.bandwidth; }
    /// Share of each joint's observer bandwidth that vibrations left, 1/256 … 1.
    JointVector bandwidth_share() const { return joint_vector(observer_.share()); }
    /// Position minus reference where the loop began with a lead-in, rad (m); zeros without one.
    const JointVector& start_offset() const noexcept { return task_.lead_in_offset(); }
    /// Duration of the lead-in, s; 0: none.
    double lead_in_s() const noexcept { return task_.lead_in_s(); }
    const LoopCounters& counters() const noexcept { return counters_; }
    const FeedForward& feed_forward() const noexcept { return feed_forward_; }

    /// Enables or disables the learned torque; see FeedForward.
    void enable_learned(bool on) noexcept { feed_forward_.enable_learned(on); }

  private:
    using Observer = DisturbanceObserver<double, dynamic>;

    /// The command of a tick.
    struct Sent {
        JointVector torque; ///< N·m
        bool full = false;  ///< it equals the torque of the motion: neither limited nor without positions
    };

    /// A sample of a future tick.
    struct EarlySample {
        std::uint64_t tick = 0; ///< 0: none
        JointVector position;
        std::vector<bool> missing;
        bool found_late = false; ///< by a late tick
    };

    void sense(const LoopInput& input);
    void take(int ticks_ago, const JointVector& position, const std::vector<bool>* missing);
    /// Begins the motion at the position of the arm.
    void begin();
    void follow();
    /// Reacts to the monitor's findings, once per change and cause.
    void act();
    /// Time since the beginning of the motion.
    double time_s() const noexcept { return config_.period_s * static_cast<double>(tick_); }
    /// Begins the reaction to a contact.
    void meet_contact();
    /// Begins to yield at a contact, and stops yielding after it.
    void yield(bool contact);
    /// Moves the references so far by `distance`, rad.
    void move_reference(const JointVector& distance);
    /// Holds the arm at its measured position from now on.
    void rest_here();
    /// Returns the torque during a contact.
    JointVector compliant_torque();
    /// Returns `torque`, limited to a change of a torque limit per `stop_time_s` since the last command.
    JointVector slowly(const JointVector& torque) const;
    /// Limits the change of the feedback and observer torque `wanted`.
    JointVector gradually(const JointVector& wanted);
    JointVector disturbance();
    /// Returns `torque` with NaN at the joints without a regular reading.
    JointVector of_regular_joints(JointVector torque) const;
    /// Returns the command that the motion requires; NaN for joints whose command was limited or whose
    /// readings are not regular.
    JointVector required_torque() const;
    /// Passes this tick's sample to the learner, at its own time.
    void learn();
    /// Returns the command in effect at the time of the measurement of `ago` ticks before this tick's. Null
    /// before the first one.
    const Sent* command_then(int ago) const noexcept;
    void hold();
    JointVector holding_torque();
    /// Returns the torque of the gains about the braking reference; NaN for joints that are not damped.
    JointVector braking_feedback() const;
    /// Returns the disturbance to compensate during the stop. `feedback`: see braking_feedback.
    JointVector braking_disturbance(const JointVector& feedback);
    void begin_braking(Eigen::Index joint);
    void brake();
    void request_brakes();
    bool brakes_closed() const noexcept;
    /// Returns whether the torque shall go to zero for good: the brakes have closed and the loop ends.
    bool releases() const noexcept;
    /// Limits the command. Returns whether it was beyond its limit.
    bool limit();
    /// Returns the reference at the time of the measurement of `ago` ticks before this tick.
    const Reference& measured_reference(int ago = 0) const noexcept;
    bool moved() const noexcept { return counters_.running > 0; }
    bool heard(Eigen::Index joint) const noexcept { return feedback_.age(joint) <= damping_ticks; }
    bool damped(Eigen::Index joint) const noexcept { return heard(joint) && feedback_.settled(joint); }

    LoopConfig config_;
    FeedForward feed_forward_;
    PositionFeedback feedback_;
    SampleClock clock_;
    JointWatch watch_;
    SafeStop safe_stop_;
    PausableTask task_;
    std::vector<Reference> references_; ///< ring: from the oldest measurement in use to this tick
    std::vector<Sent> commands_;        ///< ring over the same ticks
    std::size_t tick_ = 0;              ///< number in the motion
    std::int64_t passed_tick_ = -1;     ///< of the last position that the learner was offered
    int sample_age_ = 0;                ///< ticks from the last regular sample to its tick
    std::int64_t start_ns_ = 0;         ///< measurement time of its first tick, on the loop's grid
    Observer observer_;
    JointVector zero_, error_, command_;
    JointVector excess_;          ///< part of the last command that the limits removed
    JointVector feedback_torque_; ///< part of the command without feed-forward
    int recovery_ = 0;            ///< remaining regular ticks with limited feedback
    EarlySample early_;
    std::vector<bool> missing_; ///< joints without a reading at this tick
    /// ticks since the measurement of this tick's sample, if all its readings are regular
    std::optional<int> learnable_ago_;
    Reference braking_;           ///< reference of joints that brake or hold; empty before
    std::vector<bool> blind_;     ///< joints that brake without readings
    std::vector<bool> unsettled_; ///< joints that brake with a reading that is not believed
    std::optional<std::uint64_t> stopped_tick_, brake_tick_;
    std::uint64_t position_tick_ = 0; ///< tick of the last sample
    bool released_ = false;           ///< the torque goes to zero for good
    bool told_ = false;               ///< a stop was requested
    bool touched_ = false;            ///< a contact has ended the motion
    bool yields_ = false;             ///< the arm may be pushed
    double calm_for_s_ = 0;           ///< since the end of the contact
    Reference rest_;                  ///< held position after yielding; empty before
    TakenActions actions_;
    std::size_t acted_number_ = 0; ///< number of the last change with a reaction …
    std::uint32_t acted_on_ = 0;   ///< … and its causes with one, a bit each
    LoopCounters counters_;
};

} // namespace dfdyn::tools
