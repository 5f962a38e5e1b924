// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/gate/motion_line.hpp"

#include <cstdint>

namespace dfdyn::tools {

/// What is odd about the values of one joint, frame by frame, that its device has no word for. Judges whole
/// recordings afterwards, so it may use what came after a value; it refuses nothing.
class ValueWatch {
  public:
    /// `turn_rad`: the positions at which the joint's encoder begins anew lie so far apart; 0: never.
    /// `limits`: see hal::MotionGate, which refuses by them.
    explicit ValueWatch(double turn_rad = 0, const hal::MotionLimits& limits = {})
        : turn_rad_(turn_rad), limits_(limits) {}

    void take(const hal::JointValue& value);

    std::uint64_t positions() const noexcept { return positions_; }
    std::uint64_t efforts() const noexcept { return efforts_; }

    /// Steps between two positions that no joint can do, and how many of them were a whole turn.
    std::uint64_t jumps() const noexcept { return jumps_; }
    std::uint64_t wraps() const noexcept { return wraps_; }
    double largest_jump_rad() const noexcept { return largest_jump_rad_; }
    /// Whether the last position was exactly 0 counts.
    bool at_zero() const noexcept { return at_zero_; }
    /// Positions of exactly 0 counts that lie apart from those before.
    std::uint64_t zeros() const noexcept { return zeros_; }
    /// Positions that repeated the one before after the joint had stopped as no joint can, or until it
    /// jumped.
    std::uint64_t frozen_positions() const noexcept { return frozen_positions_ + pending_frozen(); }
    /// Efforts that repeated the one before while the joint moved.
    std::uint64_t frozen_efforts() const noexcept { return frozen_efforts_; }
    /// Efforts at an end of their numbers.
    std::uint64_t saturated_efforts() const noexcept { return saturated_efforts_; }

  private:
    void take_position(const hal::JointValue& value);
    void take_step(std::int64_t step_ns, double step_rad);
    bool jumped(std::int64_t step_ns, double step_rad) const;
    void count_jump(bool jump, double step_rad);
    double stop_within(double step_s) const;
    bool is_long() const noexcept;
    void take_effort(const hal::JointValue& value);
    std::uint64_t pending_frozen() const noexcept;

    double turn_rad_;
    hal::MotionLimits limits_;
    std::uint64_t positions_ = 0, efforts_ = 0;
    std::uint64_t jumps_ = 0, wraps_ = 0, zeros_ = 0;
    double largest_jump_rad_ = 0;

    bool started_ = false;
    bool at_zero_ = false;
    bool zero_ = false; ///< the last position was one of `zeros_`
    std::int64_t stamp_ns_ = 0;
    double position_rad_ = 0;
    double mean_interval_ns_ = 0; ///< of positions
    double speed_rad_per_s_ = 0;  ///< mean of the last steps
    double last_speed_rad_per_s_ = 0;
    double steps_per_change_ = 1;    ///< positions until the encoder shows another one
    double smallest_step_rad_ = 1;   ///< that was not 0
    double stop_rad_per_s2_ = 0;     ///< what the joint did when the run of equal positions began
    std::uint64_t equal_ = 0;        ///< positions that repeated the one before, in a row
    std::int64_t equal_from_ns_ = 0; ///< since when
    std::uint64_t frozen_positions_ = 0;

    bool effort_started_ = false;
    double effort_ = 0;
    std::uint64_t equal_efforts_ = 0;
    double lowest_rad_ = 0, highest_rad_ = 0; ///< positions since the effort's last change
    std::int64_t effort_changed_ns_ = 0;
    std::uint64_t frozen_efforts_ = 0, saturated_efforts_ = 0;
};

} // namespace dfdyn::tools
