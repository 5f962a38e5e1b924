// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/feed_forward.hpp"
#include "tools/control/position_feedback.hpp"
#include "tools/control/safe_stop.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace dfdyn::tools {

struct LoopConfig {
    double period_s = 0.001;
    int knot_ticks = 8;  ///< ticks of a knot: the learned model's sample period
    int delay_ticks = 0; ///< ticks between a measurement and the tick that gets it
    FeedbackGains gains;
    DerivativeModel filter;   ///< of the velocity
    JointVector torque_limit; ///< N·m, of every command
    SafeStopConfig safe_stop;
};

/// What there is to know at one tick.
struct LoopInput {
    std::int64_t time_ns = 0;              ///< of the measurement; rises by the period
    const JointVector* position = nullptr; ///< none: nothing that can be believed
    const JointVector* torque = nullptr;   ///< measured, at the same instant; likewise
    bool deadline_missed = false;
    bool bus_lost = false;
    bool stop_requested = false;
};

struct LoopCounters {
    std::uint64_t ticks = 0;
    std::uint64_t running = 0; ///< of them: followed the reference
    std::uint64_t coasted = 0; ///< of those: without a measured position
    std::uint64_t missed_deadlines = 0;
    std::uint64_t limited = 0; ///< with a torque at its limit, of any joint
};

/// A joint-level control loop: feed-forward for the reference, feedback of the positions, limits, a safe end.
/// Knows no operating system and no bus: whoever calls it keeps the time. One tick: see FeedForward and
/// PositionFeedback; bounded.
///
/// It begins when the arm has positions, and stands where the reference begins. The torque that ends it holds
/// the arm against gravity (by the nominal rigid body) and damps it with the feedback's velocity gains;
/// before the loop has moved anything it is zero. Without positions gravity is that of the last ones.
class ControlLoop {
  public:
    ControlLoop(LoopConfig config, FeedForward feed_forward, std::unique_ptr<Task> task);

    /// The command until the next tick, N·m.
    const JointVector& tick(const LoopInput& input);

    LoopState state() const noexcept { return safe_stop_.state(); }
    StopCause cause() const noexcept { return safe_stop_.cause(); }
    /// What the arm was to do at the last tick.
    const Reference& reference() const noexcept { return references_[tick_ % references_.size()]; }
    const LoopCounters& counters() const noexcept { return counters_; }
    const FeedForward& feed_forward() const noexcept { return feed_forward_; }

  private:
    void sense(const LoopInput& input);
    void follow(const LoopInput& input);
    void hold();
    void limit();
    /// Of the instant of the measurements.
    const Reference& measured_reference() const noexcept;
    bool moved() const noexcept { return counters_.running > 0; }

    LoopConfig config_;
    FeedForward feed_forward_;
    PositionFeedback feedback_;
    SafeStop safe_stop_;
    std::unique_ptr<Task> task_;
    std::vector<Reference> references_; ///< ring: from that of the measurements to that of the next knot
    std::size_t tick_ = 0;              ///< of the motion
    JointVector zero_, command_, last_followed_;
    LoopCounters counters_;
};

} // namespace dfdyn::tools
