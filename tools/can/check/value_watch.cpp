// SPDX-License-Identifier: Apache-2.0
#include "tools/can/check/value_watch.hpp"

#include "dfdyn/hal/motion/encoder_reading.hpp"
#include "tools/can/check/bus_stream.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double few_counts = 3;
constexpr std::uint64_t least_equal = 20; ///< consecutive positions
constexpr double least_equal_s = 0.1;
constexpr std::uint64_t least_equal_efforts = 100; ///< consecutive efforts
constexpr double least_equal_efforts_s = 0.5;
constexpr double least_motion_rad = 0.02;
constexpr double silence_periods = 3;

} // namespace

void ValueWatch::take(const hal::JointValue& value) {
    if (value.position_reason != hal::Reason::waiting_for_position) {
        at_zero_ = value.raw_zero;
    }
    if (value.position_reason == hal::Reason::ok) {
        take_position(started_ ? unwrapped(value) : value);
    } else if (value.position_reason != hal::Reason::waiting_for_position) {
        after_fault_ = started_; // reported by the device
        started_ = false;
    }
    if (value.effort_reason != hal::Reason::no_output) {
        take_effort(value);
    }
}

/// Returns the value in the turn of its integer that is nearest to the last position that was no jump.
hal::JointValue ValueWatch::unwrapped(hal::JointValue value) const {
    hal::EncoderReading reading{.position_rad = value.position_rad, .wrap_rad = value.wrap_rad};
    hal::unwrap_near(reading, steady_rad_);
    value.position_rad = reading.position_rad;
    return value;
}

void ValueWatch::take_position(const hal::JointValue& value) {
    ++positions_;
    const std::int64_t step_ns = value.stamp_ns - stamp_ns_;
    const double from_rad = position_rad_;
    const std::int64_t from_ns = stamp_ns_;
    const double step_rad = value.position_rad - from_rad;
    const bool comparable = started_ && step_ns > 0;
    const bool first = !std::exchange(started_, true);
    stamp_ns_ = comparable ? value.stamp_ns : std::max(stamp_ns_, value.stamp_ns);
    position_rad_ = value.position_rad;
    const bool was_zero = zero_;
    const bool silent = after_fault_ || is_silence(step_ns);
    const bool wraps = std::abs(turns_of(step_rad)) == 1;
    zero_ = value.raw_zero &&
            (was_zero || after_fault_ ||
             (comparable && ((jumped(step_ns, step_rad) && !wraps) || restarts(value, step_ns, step_rad))));
    after_fault_ = false;
    silent_before_zero_ = zero_ && !was_zero ? silent : silent_before_zero_;
    if (zero_ && !was_zero) {
        before_zero_rad_ = from_rad;
        before_zero_ns_ = from_ns;
    }
    bool moves = !first && !zero_ && !was_zero; // no motion leads from a jump or a zero to the next position
    if (comparable && moves) {
        moves = take_step(value, step_ns, step_rad);
    } else {
        take_zero(value, was_zero);
    }
    steady_rad_ = moves || first ? position_rad_ : steady_rad_;
    lowest_rad_ = moves ? std::min(lowest_rad_, position_rad_) : position_rad_;
    highest_rad_ = moves ? std::max(highest_rad_, position_rad_) : position_rad_;
}

/// Counts zeros between other positions. Zeros from which the next positions continue are the first ones of
/// an encoder that counts from there, unless the joint of an absolute one can have moved there meanwhile.
void ValueWatch::take_zero(const hal::JointValue& value, bool was_zero) {
    equal_ = 0;
    zeros_in_a_row_ = zero_ ? zeros_in_a_row_ + 1 : zeros_in_a_row_;
    zeros_ += zero_ ? 1 : 0;
    if (zero_ || !was_zero) {
        return;
    }
    const bool can_have_moved =
        limits_.encoder == hal::Encoder::absolute &&
        !jumped(value.stamp_ns - before_zero_ns_, value.position_rad - before_zero_rad_);
    if (!can_have_moved && !jumped(0, value.from_zero_rad)) {
        zeros_ -= zeros_in_a_row_;
        count_jump(true, value.position_rad - before_zero_rad_);
        note_jump(value, before_zero_rad_, silent_before_zero_);
    }
    zeros_in_a_row_ = 0;
}

void ValueWatch::note_jump(const hal::JointValue& value, double from_rad, bool after_silence) {
    const double turns = turns_of(value.position_rad - from_rad);
    if (first_jumps_.size() < most_jumps) {
        first_jumps_.push_back({.time_ns = value.stamp_ns,
                                .from_rad = from_rad,
                                .to_rad = value.position_rad,
                                .count_rad = value.step_rad,
                                .from_zero_rad = value.from_zero_rad,
                                .period_s = mean_interval_s(),
                                .turn = turns != 0,
                                .one_turn = std::abs(turns) == 1,
                                .after_silence = after_silence,
                                .absolute = limits_.encoder == hal::Encoder::absolute});
    }
}

/// Returns true if the positions after a silence begin at the device's zero, without a motion to there. An
/// absolute encoder keeps its zero.
bool ValueWatch::restarts(const hal::JointValue& value, std::int64_t step_ns, double step_rad) const {
    if (limits_.encoder == hal::Encoder::absolute) {
        return false;
    }
    const double silence_s = seconds_of(step_ns);
    const double rounding_rad = few_counts * value.step_rad;
    const double in_a_period_rad = std::abs(last_speed_rad_per_s_) * mean_interval_s();
    const double reach_rad =
        std::abs(last_speed_rad_per_s_) * silence_s + 0.5 * limits_.stop * silence_s * silence_s;
    const bool exactly = value.raw_zero && std::abs(step_rad) > in_a_period_rad + rounding_rad;
    const bool beyond_reach = std::abs(step_rad) > reach_rad + rounding_rad &&
                              std::abs(value.from_zero_rad) <= 2 * in_a_period_rad + rounding_rad;
    return is_silence(step_ns) && (exactly || beyond_reach);
}

bool ValueWatch::is_silence(std::int64_t step_ns) const {
    return static_cast<double>(step_ns) > silence_periods * mean_interval_ns_;
}

/// Limits the effect of a silence on the mean interval.
void ValueWatch::follow_interval(std::int64_t step_ns) {
    const auto interval_ns = static_cast<double>(step_ns);
    const double most_ns = mean_interval_ns_ > 0 ? silence_periods * mean_interval_ns_ : interval_ns;
    mean_interval_ns_ = mean_interval_ns_ > 0 ? mean_interval_ns_ : interval_ns;
    mean_interval_ns_ += 0.1 * (std::min(interval_ns, most_ns) - mean_interval_ns_);
}

/// Returns true if the joint can have made the step.
bool ValueWatch::take_step(const hal::JointValue& value, std::int64_t step_ns, double step_rad) {
    const double step_s = seconds_of(step_ns);
    const bool far = std::abs(step_rad) > few_counts * smallest_step_rad_;
    const bool thaws = is_long() && far && std::abs(step_rad) / step_s > limits_.acceleration * step_s;
    settle_thaw(value);
    const bool jump = !thaws && (jumped(step_ns, step_rad) || restarts(value, step_ns, step_rad));
    if (jump) {
        note_jump(value, value.position_rad - step_rad + last_speed_rad_per_s_ * mean_interval_s(),
                  is_silence(step_ns));
    }
    if (replayed_.take(value.position_rad, jump) && !first_jumps_.empty()) {
        first_jumps_.back().replays = true;
    }
    follow_interval(step_ns);
    if (step_rad == 0) {
        if (equal_ == 0) {
            equal_from_ns_ = stamp_ns_;
            stop_rad_per_s2_ = stop_within(step_s);
        }
        ++equal_;
        return true;
    }
    smallest_step_rad_ = std::min(smallest_step_rad_, std::abs(step_rad));
    if (thaws) {
        thawed_ = equal_;
        thawed_from_rad_ = value.position_rad - step_rad;
    } else {
        frozen_positions_ += pending_frozen();
        count_jump(jump, step_rad);
    }
    // Measured since the last change, because single counts of a coarse encoder are not a speed.
    const double changed_s = step_s * static_cast<double>(equal_ + 1);
    steps_per_change_ += 0.3 * (static_cast<double>(equal_ + 1) - steps_per_change_);
    last_speed_rad_per_s_ = jump ? 0 : step_rad / changed_s;
    speed_rad_per_s_ = jump ? 0 : speed_rad_per_s_ + 0.3 * (last_speed_rad_per_s_ - speed_rad_per_s_);
    equal_ = 0;
    return !jump && !thaws;
}

/// Decides if the positions before the last step were frozen. If the next position returns to them, a bit
/// flipped while the joint was at rest.
void ValueWatch::settle_thaw(const hal::JointValue& value) {
    const double back_rad = std::abs(value.position_rad - thawed_from_rad_);
    if (thawed_ > 0 && value.position_rad != position_before_rad_) {
        const bool back = back_rad < 0.5 * std::abs(position_before_rad_ - thawed_from_rad_);
        frozen_positions_ += back ? 0 : thawed_;
        thawed_ = 0;
    }
    position_before_rad_ = value.position_rad;
}

/// Number of whole turns of the encoder; 0 for steps that are not whole turns.
double ValueWatch::turns_of(double step_rad) const {
    const double turns = turn_rad_ > 0 ? step_rad / turn_rad_ : 0;
    return std::abs(turns - std::round(turns)) < 0.05 ? std::round(turns) : 0;
}

void ValueWatch::count_jump(bool jump, double step_rad) {
    if (!jump) {
        return;
    }
    ++jumps_;
    largest_jump_rad_ = std::max(largest_jump_rad_, std::abs(step_rad));
}

/// Deceleration of a joint whose position did not change in `step_s`. A fine encoder shows the stop
/// immediately; a coarse one shows it only within the time of one count. A joint that brakes has already
/// slowed down.
double ValueWatch::stop_within(double step_s) const {
    const double speed = std::min(std::abs(last_speed_rad_per_s_), std::abs(speed_rad_per_s_));
    const bool coarse = steps_per_change_ > 1.5;
    // Over the last count, a joint braking with deceleration a appears to brake with 2 to 4 times a.
    return coarse ? speed / (4 * step_s * steps_per_change_) : speed / step_s;
}

bool ValueWatch::is_long() const noexcept {
    return equal_ >= least_equal && seconds_of(stamp_ns_ - equal_from_ns_) >= least_equal_s;
}

/// Returns true if the step exceeds the velocity limit. At least half a mean interval is assumed, because a
/// late frame can be close to its successor.
bool ValueWatch::jumped(std::int64_t step_ns, double step_rad) const {
    const double step_s = std::max(seconds_of(step_ns), 0.5e-9 * mean_interval_ns_);
    return std::abs(step_rad) > limits_.velocity * step_s;
}

/// Returns the frozen positions in the current run of equal positions.
std::uint64_t ValueWatch::pending_frozen() const noexcept {
    return is_long() && stop_rad_per_s2_ > limits_.stop ? equal_ : 0;
}

void ValueWatch::take_effort(const hal::JointValue& value) {
    ++efforts_;
    saturated_efforts_ += value.effort_reason == hal::Reason::output_saturated ? 1 : 0;
    if (!effort_started_ || value.effort != effort_) {
        equal_efforts_ = 0;
        lowest_rad_ = highest_rad_ = position_rad_;
        effort_changed_ns_ = value.stamp_ns;
    }
    effort_started_ = true;
    effort_ = value.effort;
    ++equal_efforts_;
    const bool long_run = equal_efforts_ >= least_equal_efforts &&
                          seconds_of(value.stamp_ns - effort_changed_ns_) >= least_equal_efforts_s;
    if (long_run && highest_rad_ - lowest_rad_ > least_motion_rad && value.effort_reason == hal::Reason::ok) {
        ++frozen_efforts_;
    }
}

} // namespace dfdyn::tools
