// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/position_feedback.hpp"

#include "dfdyn/input/adaptive_window.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dfdyn::tools {

PositionFeedback::PositionFeedback(FeedbackGains gains, const DerivativeModel& filter, double period_s,
                                   MotionBounds bounds)
    : gains_(std::move(gains)), filter_(filter), period_s_(period_s), bounds_(std::move(bounds)),
      window_(std::max(settled_readings, filter.velocity_window)) {
    const Eigen::Index joints = gains_.position.size();
    const auto count = static_cast<std::size_t>(joints);
    reading_tick_.resize(count * static_cast<std::size_t>(window_));
    reading_.resize(reading_tick_.size());
    reference_.resize(reading_tick_.size());
    time_.resize(static_cast<std::size_t>(window_));
    held_.resize(count);
    newest_tick_.assign(count, std::numeric_limits<std::int32_t>::min());
    observed_tick_ = newest_tick_;
    regular_.resize(count);
    believed_.resize(count);
    restart_.resize(count);
    newest_ = velocity_ = reading_error_ = reading_rate_ = smallest_step_ = JointVector::Zero(joints);
}

double PositionFeedback::noise_bound(Eigen::Index joint) const noexcept {
    constexpr double largest_count = 4; // noise bounds; a larger step is motion
    const double step = smallest_step_[joint], given = filter_.noise_bound;
    return given <= 0 || step <= largest_count * given ? std::max(given, step) : given;
}

void PositionFeedback::push(Eigen::Index joint, std::int64_t tick, double position, double reference) {
    const auto j = static_cast<std::size_t>(joint);
    const auto first = static_cast<std::ptrdiff_t>(j) * window_;
    if (const double step = std::abs(position - newest_[joint]); held_[j] > 0 && step > 0) {
        smallest_step_[joint] = smallest_step_[joint] > 0 ? std::min(step, smallest_step_[joint]) : step;
    }
    const auto age = [&](auto& values) {
        std::copy_backward(values.begin() + first, values.begin() + first + window_ - 1,
                           values.begin() + first + window_);
    };
    age(reading_);
    age(reference_);
    age(reading_tick_);
    reading_[static_cast<std::size_t>(first)] = position;
    reference_[static_cast<std::size_t>(first)] = reference;
    reading_tick_[static_cast<std::size_t>(first)] = tick;
    held_[j] = std::min(held_[j] + 1, window_);
    newest_tick_[j] = tick;
    newest_[joint] = position;
    const int count = std::min(held_[j], filter_.velocity_window);
    for (int i = 0; i < count; ++i) {
        const std::int64_t ago = tick - reading_tick_[static_cast<std::size_t>(first + i)];
        time_[static_cast<std::size_t>(i)] = -period_s_ * static_cast<double>(ago);
    }
    if (count > 1) {
        const AdaptiveWindow<double> window(time_.data(), reading_.data() + first, 1, count,
                                            noise_bound(joint));
        velocity_[joint] = reachable(joint, tick, window.velocity());
        reading_rate_[joint] = window.slope_of(reference_.data() + first) - velocity_[joint];
    }
}

void PositionFeedback::restart(Eigen::Index joint) {
    const auto j = static_cast<std::size_t>(joint);
    const bool returns = !settled(joint);
    if (returns) { // to the motion before the jump
        velocity_[joint] = restart_[j].velocity;
        reading_rate_[joint] = restart_[j].rate;
        restart_[j].jumped = false;
    } else {
        restart_[j] = {newest_tick_[j],       newest_[joint],      velocity_[joint],
                       reading_error_[joint], bounded_rate(joint), true};
    }
    held_[j] = 0;
}

double PositionFeedback::reachable(Eigen::Index joint, std::int64_t tick, double velocity) const noexcept {
    const auto j = static_cast<std::size_t>(joint);
    const Restart& last = restart_[j];
    if (held_[j] >= window_ || last.tick < 0) {
        return velocity;
    }
    const double time_s = period_s_ * static_cast<double>(tick - last.tick);
    const double change = bounds_.acceleration[joint] * time_s;
    const double limited = std::clamp(velocity, last.velocity - change, last.velocity + change);
    return std::abs(velocity - limited) * time_s <= 2 * noise_bound(joint) ? limited : velocity;
}

bool PositionFeedback::plausible(Eigen::Index joint, std::int64_t tick, double position,
                                 const Reference& reference) const noexcept {
    const auto j = static_cast<std::size_t>(joint);
    const double noise = noise_bound(joint);
    if (bounds_.acceleration.size() == 0 || noise <= 0) { // without a bound the first step is the count
        return true;
    }
    const auto follows = [&](std::int64_t since, double error, double rate) {
        const double time_s = period_s_ * static_cast<double>(tick - since);
        const double surprise = reference.position[joint] - position - error - rate * time_s;
        return std::abs(surprise) <= bounds_.acceleration[joint] * time_s * time_s + 4 * noise;
    };
    const Restart& last = restart_[j];
    if (!settled(joint)) {
        return !follows(last.tick, last.error, last.rate); // a return is not plausible after the jump
    }
    if (held_[j] < settled_readings && last.tick < 0) { // nothing to compare the first readings with
        return true;
    }
    // without the fading of error_at, which at a high rate would be an acceleration
    return follows(newest_tick_[j], reading_error_[joint], bounded_rate(joint));
}

bool PositionFeedback::continues(Eigen::Index joint, std::int64_t tick, double position) const noexcept {
    const auto j = static_cast<std::size_t>(joint);
    if (held_[j] < 2) {
        return true; // any velocity: something may have hit the arm
    }
    const auto first = j * static_cast<std::size_t>(window_);
    const double time_s = period_s_ * static_cast<double>(tick - reading_tick_[first]);
    const double last_s = period_s_ * static_cast<double>(reading_tick_[first] - reading_tick_[first + 1]);
    const double expected = (reading_[first] - reading_[first + 1]) / last_s * time_s;
    return std::abs(position - reading_[first] - expected) <=
           bounds_.acceleration[joint] * time_s * (time_s + last_s) + 4 * noise_bound(joint);
}

void PositionFeedback::observe(int ticks_ago, const JointVector& position, const Reference& reference,
                               const std::vector<bool>* missing) {
    const std::int64_t tick = tick_ - ticks_ago;
    for (Eigen::Index joint = 0; joint < position.size(); ++joint) {
        const auto j = static_cast<std::size_t>(joint);
        if ((missing != nullptr && (*missing)[j]) || tick <= newest_tick_[j]) {
            continue;
        }
        const bool next = held_[j] == 0 || tick == newest_tick_[j] + 1;
        const bool believed = plausible(joint, tick, position[joint], reference);
        believed_[j] = believed;
        if (!believed) {
            restart(joint);
        } else if (!settled(joint) && !continues(joint, tick, position[joint])) {
            held_[j] = 0; // another jump
        }
        push(joint, tick, position[joint], reference.position[joint]);
        regular_[j] = next && believed && settled(joint);
        observed_tick_[j] = tick_;
        reading_error_[joint] = reference.position[joint] - position[joint];
    }
    if (position_.size() > 0 || std::ranges::all_of(held_, [](int held) { return held > 0; })) {
        position_ = newest_;
    }
}

void PositionFeedback::move_reference(const JointVector& distance) {
    for (std::size_t i = 0; i < reference_.size(); ++i) {
        reference_[i] += distance[static_cast<Eigen::Index>(i) / window_];
    }
    reading_error_ += distance;
}

PositionFeedback::JointMotion PositionFeedback::believed_motion(Eigen::Index joint) const noexcept {
    const auto j = static_cast<std::size_t>(joint);
    const Restart& last = restart_[j];
    const bool reading = settled(joint);
    const double velocity = within_speed(joint, reading ? velocity_[joint] : last.velocity);
    const std::int64_t tick = reading ? newest_tick_[j] : last.tick;
    const double time_s = period_s_ * static_cast<double>(tick_ - tick);
    return {(reading ? newest_[joint] : last.position) + velocity * time_s, velocity};
}

bool PositionFeedback::settled(Eigen::Index joint) const noexcept {
    const auto j = static_cast<std::size_t>(joint);
    return !restart_[j].jumped || held_[j] >= settled_readings;
}

void PositionFeedback::hold_reference(const JointVector& reference) {
    for (Eigen::Index joint = 0; joint < reference.size(); ++joint) {
        const auto j = static_cast<std::size_t>(joint);
        std::fill_n(reference_.begin() + static_cast<std::ptrdiff_t>(j) * window_, window_, reference[joint]);
        reading_error_[joint] = reference[joint] - newest_[joint];
        reading_rate_[joint] = -velocity_[joint];
        restart_[j].error = reference[joint] - restart_[j].position;
        restart_[j].rate = -restart_[j].velocity;
    }
}

double PositionFeedback::error_at(Eigen::Index joint, std::int64_t tick) const noexcept {
    const auto ticks = static_cast<double>(
        std::clamp<std::int64_t>(tick - newest_tick_[static_cast<std::size_t>(joint)], 0, fade_ticks));
    return reading_error_[joint] +
           bounded_rate(joint) * period_s_ * (ticks - ticks * ticks / (2 * fade_ticks));
}

double PositionFeedback::rate_at(Eigen::Index joint, std::int64_t tick) const noexcept {
    const auto ticks = static_cast<double>(
        std::clamp<std::int64_t>(tick - newest_tick_[static_cast<std::size_t>(joint)], 0, fade_ticks));
    return bounded_rate(joint) * (1 - ticks / fade_ticks);
}

double PositionFeedback::bounded_rate(Eigen::Index joint) const noexcept {
    return within_speed(joint, reading_rate_[joint]);
}

double PositionFeedback::within_speed(Eigen::Index joint, double velocity) const noexcept {
    const double most = bounds_.speed.size() > 0 ? bounds_.speed[joint] : std::numeric_limits<double>::max();
    return std::clamp(velocity, -most, most);
}

JointVector PositionFeedback::error() const {
    JointVector result(newest_.size());
    for (Eigen::Index joint = 0; joint < result.size(); ++joint) {
        result[joint] = error_at(joint, tick_);
    }
    return result;
}

JointVector PositionFeedback::error_rate() const {
    JointVector result(newest_.size());
    for (Eigen::Index joint = 0; joint < result.size(); ++joint) {
        result[joint] = rate_at(joint, tick_);
    }
    return result;
}

JointVector PositionFeedback::torque() const {
    JointVector result(newest_.size());
    for (Eigen::Index joint = 0; joint < result.size(); ++joint) {
        result[joint] =
            gains_.position[joint] * error_at(joint, tick_) + gains_.velocity[joint] * rate_at(joint, tick_);
    }
    return result;
}

int PositionFeedback::longest_silence() const noexcept {
    constexpr std::int64_t most = std::numeric_limits<int>::max();
    return static_cast<int>(std::min(tick_ - std::ranges::min(observed_tick_), most));
}

std::optional<Eigen::Index> PositionFeedback::silent_joint() const noexcept {
    const auto oldest = std::ranges::min_element(observed_tick_);
    const auto silent =
        std::ranges::count_if(observed_tick_, [&](std::int64_t tick) { return tick < tick_; });
    return silent == 1 ? std::optional(oldest - observed_tick_.begin()) : std::nullopt;
}

bool PositionFeedback::known() const noexcept {
    return longest_silence() <= bridged_ticks &&
           std::ranges::all_of(believed_, [](bool believed) { return believed; });
}

bool PositionFeedback::complete() const noexcept { return longest_silence() == 0; }

bool PositionFeedback::regular(Eigen::Index joint) const noexcept {
    return observed(joint) && regular_[static_cast<std::size_t>(joint)];
}

bool PositionFeedback::regular() const noexcept {
    return complete() && std::ranges::all_of(regular_, [](bool regular) { return regular; });
}

} // namespace dfdyn::tools
