// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

#include <cstdint>

namespace dfdyn::tools {

/// What the loop is doing; it only ever goes down this list.
enum class LoopState : std::uint8_t {
    waiting,  ///< for the first positions; no torque
    running,  ///< follows the reference
    stopping, ///< damps the arm; its torque goes over to that which holds the arm against gravity
    stopped,  ///< holds and damps
};

/// Why it stopped, or is stopping.
enum class StopCause : std::uint8_t {
    none,
    requested,        ///< a signal, or the motion's end
    no_position,      ///< none that can be believed, for longer than the patience
    missed_deadlines, ///< as many in a row as the patience
    following_error,  ///< a joint is further from its reference than allowed: blocked, or not ours to move
    bus_lost,         ///< the bus is off, or its interface down
    overspeed,        ///< a joint is faster than allowed
    torque_limit,     ///< a joint pressed at its torque limit, and did not move
    frozen_encoder,   ///< a joint's reading repeats while the joint must have moved
    finding,          ///< the learner's monitor named a change whose action is to stop
};

const char* name(LoopState state) noexcept;
const char* name(StopCause cause) noexcept;

/// What holds an arm that has stopped.
enum class StopMode : std::uint8_t {
    hold, ///< torque, until the program ends
    limp, ///< torque until the brakes had time to close, then none
};

/// Limits and patience; see StopCause. An empty vector is no limit. Ticks are those of the loop.
struct SafeStopConfig {
    int position_patience = 5;   ///< lost cycles in a row that are coasted over, at most
    int return_patience = 20;    ///< beyond these, ticks in a row whose devices send, and still qualify
    int deadline_patience = 10;  ///< deadlines missed in a row, at most
    int speed_patience = 2;      ///< readings in a row beyond the speed limit, at most
    int frozen_patience = 4;     ///< readings in a row that repeat where they cannot, at most
    int pressing_ticks = 250;    ///< at the torque limit without moving, at most
    JointVector following_error; ///< rad (prismatic: m); largest while running, and where the loop starts
    JointVector speed_limit;     ///< rad/s, m/s
    JointVector torque_limit;    ///< N·m, N
    JointVector acceleration;    ///< rad/s², m/s²: twice what the torque limit causes
    int ramp_ticks = 200;        ///< of `stopping`
    int brake_ticks = 200;       ///< from the request of the brakes until they have closed
    StopMode mode = StopMode::hold;
};

/// What one tick knows about the loop's health.
struct TickHealth {
    bool position_valid = false;
    bool deadline_missed = false;
    bool bus_lost = false;
    bool stop_requested = false;
    bool returning = false;            ///< no position, from devices that send and still qualify
    StopCause joint = StopCause::none; ///< what a joint does that it must not: see JointWatch
};

/// The state machine of a loop that must end well. The first cause wins; nothing but a new loop leaves
/// `stopped`.
class SafeStop {
  public:
    explicit SafeStop(SafeStopConfig config);

    /// One tick; `error`: reference minus position, rad (looked at only where there has been a position).
    LoopState tick(const TickHealth& health, const JointVector& error);

    LoopState state() const noexcept { return state_; }
    StopCause cause() const noexcept { return cause_; }

  private:
    StopCause judge(const TickHealth& health, const JointVector& error) const;
    void count(const TickHealth& health);

    SafeStopConfig config_;
    LoopState state_ = LoopState::waiting;
    StopCause cause_ = StopCause::none;
    int lost_ = 0, returning_ = 0, missed_ = 0; ///< ticks in a row
    int ramped_ = 0;
};

} // namespace dfdyn::tools
