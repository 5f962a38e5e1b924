// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/joint_vector.hpp"

#include <cstdint>

namespace dfdyn::tools {

/// What the loop is doing; it only ever goes down this list.
enum class LoopState : std::uint8_t {
    waiting,  ///< for the first positions; no torque
    running,  ///< follows the reference
    stopping, ///< its torque goes over to that which holds the arm against gravity and damps it
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
};

const char* name(LoopState state) noexcept;
const char* name(StopCause cause) noexcept;

struct SafeStopConfig {
    int position_patience = 5;   ///< ticks in a row without a position that are coasted over, at most
    int deadline_patience = 10;  ///< deadlines missed in a row, at most
    JointVector following_error; ///< rad; largest while running, and where the loop starts
    int ramp_ticks = 200;        ///< of `stopping`
};

/// What one tick knows about the loop's health.
struct TickHealth {
    bool position_valid = false;
    bool deadline_missed = false;
    bool bus_lost = false;
    bool stop_requested = false;
};

/// The state machine of a loop that must end well. The first cause wins; nothing but a new loop leaves
/// `stopped`.
class SafeStop {
  public:
    explicit SafeStop(const SafeStopConfig& config);

    /// One tick; `error`: reference minus position, rad (looked at only where there has been a position).
    LoopState tick(const TickHealth& health, const JointVector& error);

    LoopState state() const noexcept { return state_; }
    StopCause cause() const noexcept { return cause_; }
    /// Share of the holding torque in the command: 0 while running, rising to 1 in `stopping`.
    double hold_share() const noexcept;

  private:
    StopCause judge(const TickHealth& health, const JointVector& error) const;
    void count(const TickHealth& health);

    SafeStopConfig config_;
    LoopState state_ = LoopState::waiting;
    StopCause cause_ = StopCause::none;
    int without_position_ = 0, missed_ = 0; ///< ticks in a row
    int ramped_ = 0;
};

} // namespace dfdyn::tools
