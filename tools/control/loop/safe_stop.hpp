// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

namespace dfdyn::tools {

/// State of the loop. Transitions go down this list only.
enum class LoopState : std::uint8_t {
    waiting,  ///< waits for the first positions; no torque
    running,  ///< follows the reference
    stopping, ///< damps the arm; the torque changes to the one that holds the arm against gravity
    stopped,  ///< holds and damps the arm
};

/// Reason for the stop.
enum class StopCause : std::uint8_t {
    none,
    requested,        ///< a signal, or the end of the motion
    no_position,      ///< no valid position for longer than the patience
    missed_deadlines, ///< more successive missed deadlines than the patience
    following_error,  ///< a joint is too far from its reference: blocked, or controlled by something else
    bus_lost,         ///< the bus is off, or its interface is down
    overspeed,        ///< a joint is faster than allowed
    torque_limit,     ///< a joint was at its torque limit and did not move
    frozen_encoder,   ///< a joint's reading repeats although the joint must have moved
    finding,          ///< the learner's monitor identified a change whose action is `stop`
};

const char* name(LoopState state) noexcept;
const char* name(StopCause cause) noexcept;

/// How the arm is held after a stop.
enum class StopMode : std::uint8_t {
    hold, ///< torque, until the program ends
    limp, ///< torque until the brakes had time to close, then none
};

/// Returns the next count of successive readings or ticks. It ends just beyond `patience`, so that no count
/// overflows.
constexpr int counted(int count, int patience) noexcept { return std::min(count, patience) + 1; }

/// Limits and patience; see StopCause. An empty vector means no limit. Ticks are those of the loop.
struct SafeStopConfig {
    int position_patience = 5;   ///< most successive lost cycles of a joint that are bridged
    int return_patience = 20;    ///< additional successive ticks while devices send and still qualify
    int deadline_patience = 10;  ///< most successive missed deadlines
    int speed_patience = 2;      ///< most successive readings above the speed limit
    int frozen_patience = 4;     ///< most successive identical readings of a joint that must have moved
    int pressing_ticks = 250;    ///< most ticks at the torque limit without motion
    JointVector following_error; ///< rad (prismatic: m); largest value while running and at the start
    /// rad (m): largest distance that the reference covers while friction may hold a joint
    JointVector sticking;
    JointVector speed_limit;  ///< rad/s, m/s
    JointVector torque_limit; ///< N·m, N
    JointVector acceleration; ///< rad/s², m/s²: acceleration at twice the torque limit
    int ramp_ticks = 200;     ///< duration of `stopping`
    int brake_ticks = 200;    ///< from the request of the brakes until they have closed
    StopMode mode = StopMode::hold;
};

/// Health of the loop at one tick.
struct TickHealth {
    bool position_valid = false;
    bool deadline_missed = false;
    bool bus_lost = false;
    bool stop_requested = false;
    bool returning = false;            ///< no position yet, from devices that send and still qualify
    StopCause joint = StopCause::none; ///< abnormal behaviour of a joint: see JointWatch
    /// Ticks since the last reading of the joint that has waited longest. It bounds the count of successive
    /// ticks in which different joints lack a reading.
    int longest_silence = std::numeric_limits<int>::max();
    Eigen::Index joint_number = 0;                 ///< from 0, of the joint with abnormal behaviour
    std::optional<Eigen::Index> silent_joint = {}; ///< from 0, without a reading; none: not exactly one
};

/// State machine for a safe stop. The first cause is kept. A stopped loop cannot be restarted.
class SafeStop {
  public:
    explicit SafeStop(SafeStopConfig config);

    /// Evaluates one tick; `error`: reference minus position, rad (ignored until there has been a position).
    LoopState tick(const TickHealth& health, const JointVector& error);

    LoopState state() const noexcept { return state_; }
    StopCause cause() const noexcept { return cause_; }
    /// Joint (from 0) that caused following_error, overspeed, torque_limit or frozen_encoder, or that alone
    /// caused no_position.
    std::optional<Eigen::Index> joint() const noexcept { return joint_; }

  private:
    StopCause judge(const TickHealth& health, const JointVector& error);
    void count(const TickHealth& health);

    SafeStopConfig config_;
    LoopState state_ = LoopState::waiting;
    StopCause cause_ = StopCause::none;
    std::optional<Eigen::Index> joint_;
    int lost_ = 0, returning_ = 0, missed_ = 0; ///< successive ticks
    int ramped_ = 0;
};

} // namespace dfdyn::tools
