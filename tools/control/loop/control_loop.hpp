// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/control/disturbance_observer.hpp"
#include "tools/control/loop/feed_forward.hpp"
#include "tools/control/loop/finding_actions.hpp"
#include "tools/control/loop/joint_watch.hpp"
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
    int knot_ticks = 1;  ///< of a knot: the learned model's sample period
    int delay_ticks = 0; ///< ticks between a measurement and the tick that gets it
    FeedbackGains gains;
    DerivativeModel filter;   ///< of the velocity
    JointVector torque_limit; ///< N·m, of every command
    JointVector bandwidth;    ///< of the disturbance observer, rad/s, per joint; 0: none
    SafeStopConfig safe_stop;
    FindingActions actions; ///< on what the learner's monitor finds
};

/// What there is to know at one tick.
struct LoopInput {
    /// Instant of the measurement; without one, of no meaning. One measurement per tick is expected, a period
    /// after the last: what becomes of others see SampleClock.
    std::int64_t time_ns = 0;
    const JointVector* position = nullptr;      ///< none: nothing that can be believed
    const JointVector* torque = nullptr;        ///< measured, at the same instant; likewise
    const std::vector<bool>* missing = nullptr; ///< joints whose position was not measured; null: none
    bool returning = false;                     ///< no position, from devices that send and still qualify
    bool deadline_missed = false;
    bool bus_lost = false;
    bool stop_requested = false;
};

struct LoopCounters {
    std::uint64_t ticks = 0;
    std::uint64_t running = 0; ///< of them: followed the reference
    std::uint64_t coasted = 0; ///< of those: without a measured position
    std::uint64_t limited = 0; ///< with a torque at its limit, of any joint
};

/// A joint-level control loop: feed-forward for the reference, feedback of the positions, limits, a safe end.
/// Knows no operating system and no bus: whoever calls it keeps the time. One tick: see FeedForward and
/// PositionFeedback; bounded.
///
/// It begins when the arm has positions, and stands where the reference begins. The feed-forward gets times
/// of the loop's own grid, and learns from the commands: a torque sensor that lies costs no tracking. What
/// feed-forward leaves to the feedback the disturbance observer takes over, at most `observer_share` of the
/// torque limit; while positions are missing it keeps what it has found. After a tick that was not regular
/// (see PositionFeedback) the feedback's torque changes by at most `feedback_step` of the torque limit per
/// tick, until `recovery_ticks` regular ones in a row did not need that: the correction that comes with the
/// first reading after a gap is blended in. The limit acts on a few ticks and leaves the loop's gain and
/// phase as they are while ticks are regular.
///
/// When it stops, every joint is given a reference that brakes from where it is, and how fast, to rest within
/// `stop_time_s`. The command goes over, by at most a torque limit per `stop_time_s`, to
/// - the torque that this takes, against gravity, by the nominal rigid body and what was learned
///   (FeedForward::holding) and, unless something held the arm or a reading was wrong, observed, and then
///   holds the arm;
/// - for joints with a reading of the last `damping_ticks` ticks, whatever the cause, the position and
///   velocity gains' torque, the former with at most `spring_share` of the torque limit. Joints without are
///   not damped; when their readings come back they brake from where they are then.
/// Before the loop has moved anything it is zero. The brakes are requested when no joint is faster
/// than 0.05 rad/s (m/s) in `stopped`, at once when a joint cannot be damped, and `brake_timeout_s` after
/// `stopped` at the latest. Torque ends `brake_ticks` later in StopMode::limp only.
class ControlLoop {
  public:
    static constexpr double feedback_step = 0.05;
    static constexpr double observer_share = 0.3;
    static constexpr int recovery_ticks = 10;
    static constexpr double stop_time_s = 0.1;
    static constexpr int damping_ticks = 5;
    static constexpr double spring_share = 0.5;
    static constexpr double brake_timeout_s = 1;
    static constexpr double give_up_s = 1;

    ControlLoop(LoopConfig config, FeedForward feed_forward, std::unique_ptr<Task> task);

    /// The command until the next tick, N·m.
    const JointVector& tick(const LoopInput& input);

    LoopState state() const noexcept { return safe_stop_.state(); }
    StopCause cause() const noexcept { return safe_stop_.cause(); }
    /// Joint, from 0, that the causes overspeed, torque_limit and frozen_encoder are about.
    Eigen::Index stopped_by() const noexcept { return watch_.joint(); }
    /// Actions other than to report that were taken on findings, the first 64.
    const std::vector<TakenAction>& actions() const noexcept { return actions_; }
    /// Whether the program should close the arm's brakes; once true it stays so.
    bool brake_requested() const noexcept { return brake_tick_.has_value(); }
    /// Whether the torque has ended: in StopMode::limp, after the brakes had time to close.
    bool limp() const noexcept;
    /// Whether nothing is left to do: it has stopped, the brakes are requested, and either it was told to
    /// stop (also after it had begun to by itself), or it is limp, or no positions have come for `give_up_s`.
    bool done() const noexcept;
    /// What the arm was to do at the last tick.
    const Reference& reference() const noexcept { return references_[tick_ % references_.size()]; }
    /// Reference minus position, as measured for the last tick or coasted on, rad; of the instant of the
    /// measurement.
    const JointVector& error() const noexcept { return error_; }
    const LoopCounters& counters() const noexcept { return counters_; }
    const FeedForward& feed_forward() const noexcept { return feed_forward_; }

    /// Uses what is learned, or leaves it out; see FeedForward.
    void enable_learned(bool on) noexcept { feed_forward_.enable_learned(on); }

  private:
    using Observer = DisturbanceObserver<double, dynamic>;

    /// A sample of a tick to come.
    struct EarlySample {
        std::uint64_t tick;
        JointVector position;
    };

    void sense(const LoopInput& input);
    void take(int ticks_ago, const JointVector& position, const std::vector<bool>* missing);
    void follow();
    /// On what the monitor has found, once per change and cause.
    void act();
    /// What is `wanted` of feedback and observer, in steps as small as those after a gap must be.
    JointVector after_gap(const JointVector& wanted);
    JointVector disturbance();
    /// The command that was in effect at the instant of this tick's measurement; null before the first, and
    /// where it was limited or followed from missing positions.
    const JointVector* command_then() const noexcept;
    void hold();
    JointVector holding_torque();
    void begin_braking(Eigen::Index joint);
    void brake();
    void request_brakes();
    void limit();
    /// Of the instant of the measurements, `ago` ticks before that of this tick.
    const Reference& measured_reference(int ago = 0) const noexcept;
    bool moved() const noexcept { return counters_.running > 0; }
    bool damped(Eigen::Index joint) const noexcept { return feedback_.age(joint) <= damping_ticks; }

    LoopConfig config_;
    FeedForward feed_forward_;
    PositionFeedback feedback_;
    SampleClock clock_;
    JointWatch watch_;
    SafeStop safe_stop_;
    std::unique_ptr<Task> task_;
    std::vector<Reference> references_; ///< ring: from those of old measurements to that of this tick
    std::vector<JointVector> commands_; ///< ring, likewise; empty: not what the motion took
    std::size_t tick_ = 0;              ///< of the motion
    std::int64_t start_ns_ = 0;         ///< measurement of its first tick, on the loop's grid
    Observer observer_;
    JointVector zero_, error_, command_;
    JointVector excess_;          ///< what the limits took off the last command
    JointVector feedback_torque_; ///< part of the command that is not feed-forward
    int recovery_ = 0;            ///< regular ticks until the feedback is no longer limited
    std::optional<EarlySample> early_;
    std::vector<bool> missing_; ///< joints, at this tick
    bool exact_ = false;        ///< positions of all joints were, too
    Reference braking_;         ///< of joints that brake, or hold; empty before
    std::vector<bool> blind_;   ///< joints that brake without readings
    std::optional<std::uint64_t> stopped_tick_, brake_tick_;
    std::uint64_t position_tick_ = 0; ///< of the last sample
    bool told_ = false;               ///< to stop
    std::vector<TakenAction> actions_;
    std::size_t acted_number_ = 0;    ///< of the change that was acted on last …
    Cause acted_on_ = Cause::unknown; ///< … and for which cause
    LoopCounters counters_;
};

} // namespace dfdyn::tools
