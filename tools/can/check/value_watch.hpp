// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/motion/motion_line.hpp"
#include "tools/can/check/position_jumps.hpp"

#include <cstdint>

namespace dfdyn::tools {

/// Detects implausible values of one joint that its device does not report. It evaluates whole recordings, so
/// it may use later values to judge a value; it rejects nothing.
class ValueWatch {
  public:
    /// `turn_rad`: distance between the positions at which the joint's encoder wraps; 0: it does not wrap.
    /// `limits`: see hal::MotionGate, which rejects positions by them.
    explicit ValueWatch(double turn_rad = 0, const hal::MotionLimits& limits = {})
        : turn_rad_(turn_rad), limits_(limits) {}

    void take(const hal::JointValue& value);

    std::uint64_t positions() const noexcept { return positions_; }
    std::uint64_t efforts() const noexcept { return efforts_; }

    /// Number of steps between two positions that no joint can make.
    std::uint64_t jumps() const noexcept { return jumps_; }
    double largest_jump_rad() const noexcept { return largest_jump_rad_; }
    /// The first of these steps, and positions after a silence that begin at the device's zero.
    const std::vector<PositionJump>& first_jumps() const noexcept { return first_jumps_; }
    /// True if there may be more of them than `first_jumps`.
    bool has_more_jumps() const noexcept { return first_jumps_.size() == most_jumps; }
    /// True if the last position was exactly 0 counts.
    bool at_zero() const noexcept { return at_zero_; }
    /// Number of positions of exactly 0 counts that are far from the preceding positions.
    std::uint64_t zeros() const noexcept { return zeros_; }
    /// Number of repeated positions after an impossibly sudden stop of the joint, or before a jump.
    std::uint64_t frozen_positions() const noexcept { return frozen_positions_ + thawed_ + pending_frozen(); }
    /// Number of repeated efforts while the joint moved.
    std::uint64_t frozen_efforts() const noexcept { return frozen_efforts_; }
    /// Number of efforts at an end of their range.
    std::uint64_t saturated_efforts() const noexcept { return saturated_efforts_; }

  private:
    static constexpr std::size_t most_jumps = 64;

    hal::JointValue unwrapped(hal::JointValue value) const;
    void take_position(const hal::JointValue& value);
    void take_zero(const hal::JointValue& value, bool was_zero);
    bool take_step(const hal::JointValue& value, std::int64_t step_ns, double step_rad);
    bool restarts(const hal::JointValue& value, std::int64_t step_ns, double step_rad) const;
    double turns_of(double step_rad) const;
    void note_jump(const hal::JointValue& value, double from_rad, bool after_silence);
    bool is_silence(std::int64_t step_ns) const;
    void follow_interval(std::int64_t step_ns);
    double mean_interval_s() const noexcept { return 1e-9 * mean_interval_ns_; }
    bool jumped(std::int64_t step_ns, double step_rad) const;
    void count_jump(bool jump, double step_rad);
    double stop_within(double step_s) const;
    bool is_long() const noexcept;
    void settle_thaw(const hal::JointValue& value);
    void take_effort(const hal::JointValue& value);
    std::uint64_t pending_frozen() const noexcept;

    double turn_rad_;
    hal::MotionLimits limits_;
    std::uint64_t positions_ = 0, efforts_ = 0;
    std::uint64_t jumps_ = 0, zeros_ = 0;
    double largest_jump_rad_ = 0;
    std::vector<PositionJump> first_jumps_; ///< at most `most_jumps`
    ReplayedPositions replayed_;
    double before_zero_rad_ = 0;      ///< last position before a zero of `zeros_`
    std::int64_t before_zero_ns_ = 0; ///< its stamp
    bool silent_before_zero_ = false; ///< a silence or a fault before the zero
    std::uint64_t zeros_in_a_row_ = 0;

    bool started_ = false;
    bool at_zero_ = false;
    bool after_fault_ = false; ///< the device reported a fault instead of the last position
    bool zero_ = false;        ///< the last position was one of `zeros_`
    std::int64_t stamp_ns_ = 0;
    double steady_rad_ = 0; ///< last position that was no jump and no zero
    double position_rad_ = 0;
    double mean_interval_ns_ = 0; ///< mean interval between positions
    double speed_rad_per_s_ = 0;  ///< moving average of the speed
    double last_speed_rad_per_s_ = 0;
    double steps_per_change_ = 1;    ///< mean number of positions until the encoder shows a new one
    double smallest_step_rad_ = 1;   ///< smallest nonzero step
    double stop_rad_per_s2_ = 0;     ///< deceleration at the start of the current run of equal positions
    std::uint64_t equal_ = 0;        ///< number of consecutive positions equal to the previous one
    std::int64_t equal_from_ns_ = 0; ///< start of that run
    std::uint64_t frozen_positions_ = 0;
    std::uint64_t thawed_ = 0; ///< equal positions before the last step, if that ended a freeze
    double thawed_from_rad_ = 0, position_before_rad_ = 0;

    bool effort_started_ = false;
    double effort_ = 0;
    std::uint64_t equal_efforts_ = 0;
    /// Range of the positions since the last change of the effort, or since the last jump.
    double lowest_rad_ = 0, highest_rad_ = 0;
    std::int64_t effort_changed_ns_ = 0;
    std::uint64_t frozen_efforts_ = 0, saturated_efforts_ = 0;
};

} // namespace dfdyn::tools
