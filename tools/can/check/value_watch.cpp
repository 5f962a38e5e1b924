// SPDX-License-Identifier: Apache-2.0
#include "tools/can/check/value_watch.hpp"

#include "tools/can/check/bus_stream.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double few_counts = 3;
constexpr std::uint64_t least_equal = 20; ///< consecutive positions
constexpr double least_equal_s = 0.1;
constexpr std::uint64_t least_equal_efforts = 100; ///< consecutive efforts
constexpr double least_equal_efforts_s = 0.5;
constexpr double least_motion_rad = 0.02;

} // namespace

void ValueWatch::take(const hal::JointValue& value) {
    if (value.position_reason != hal::Reason::waiting_for_position) {
        at_zero_ = value.raw_zero;
    }
    if (value.position_reason == hal::Reason::ok) {
        take_position(value);
    } else if (value.position_reason != hal::Reason::waiting_for_position) {
        started_ = false; // the device reports the fault itself
    }
    if (value.effort_reason != hal::Reason::no_output) {
        take_effort(value);
    }
}

void ValueWatch::take_position(const hal::JointValue& value) {
    ++positions_;
    const std::int64_t step_ns = value.stamp_ns - stamp_ns_;
    const double step_rad = value.position_rad - position_rad_;
    const bool comparable = started_ && step_ns > 0;
    started_ = true;
    stamp_ns_ = comparable ? value.stamp_ns : std::max(stamp_ns_, value.stamp_ns);
    position_rad_ = value.position_rad;
    const bool was_zero = zero_;
    zero_ = value.raw_zero && (was_zero || (comparable && jumped(step_ns, step_rad)));
    zeros_ += zero_ ? 1 : 0;
    if (!comparable || zero_ || was_zero) {
        equal_ = 0;
        return;
    }
    take_step(step_ns, step_rad);
    lowest_rad_ = std::min(lowest_rad_, position_rad_);
    highest_rad_ = std::max(highest_rad_, position_rad_);
}

void ValueWatch::take_step(std::int64_t step_ns, double step_rad) {
    const double step_s = seconds_of(step_ns);
    mean_interval_ns_ += 0.1 * (static_cast<double>(step_ns) - mean_interval_ns_);
    if (step_rad == 0) {
        if (equal_ == 0) {
            equal_from_ns_ = stamp_ns_;
            stop_rad_per_s2_ = stop_within(step_s);
        }
        ++equal_;
        return;
    }
    smallest_step_rad_ = std::min(smallest_step_rad_, std::abs(step_rad));
    const bool jump = jumped(step_ns, step_rad);
    const bool far = std::abs(step_rad) > few_counts * smallest_step_rad_;
    if (is_long() && far && std::abs(step_rad) / step_s > limits_.acceleration * step_s) {
        frozen_positions_ += equal_;
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
}

void ValueWatch::count_jump(bool jump, double step_rad) {
    if (!jump) {
        return;
    }
    const double turns = turn_rad_ > 0 ? step_rad / turn_rad_ : 0.5;
    ++jumps_;
    wraps_ += std::abs(turns - std::round(turns)) < 0.05 ? 1 : 0;
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

/// Frozen positions of the present run of equal positions.
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
    if (equal_efforts_ >= least_equal_efforts && highest_rad_ - lowest_rad_ > least_motion_rad &&
        seconds_of(value.stamp_ns - effort_changed_ns_) >= least_equal_efforts_s &&
        value.effort_reason == hal::Reason::ok) {
        ++frozen_efforts_;
    }
}

} // namespace dfdyn::tools
