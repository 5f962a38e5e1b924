// SPDX-License-Identifier: Apache-2.0
#include "tools/can/motors/velocity_check.hpp"

#include "dfdyn/hal/motion/encoder_reading.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double least_speed = 0.05; ///< rad/s; if both are below it, the resolution is too coarse
constexpr double longest_step_s = 0.1;
constexpr double least_distance_rad = 0.2;
constexpr double least_steps = 20;
constexpr double least_variation = 1e-4; ///< ratio of the velocity's variance to its mean square
constexpr double largest_deviation = 0.1;
constexpr double errors_to_be_sure = 5; ///< in standard errors

} // namespace

void VelocityCheck::take(const hal::JointValue& value) noexcept {
    if (value.has_velocity) {
        velocity_ = value.velocity;
        velocity_ns_ = value.stamp_ns;
        has_velocity_ = true;
    }
    if (value.position_reason == hal::Reason::waiting_for_position) {
        return; // no position in this frame
    }
    const double step_s = hal::seconds_between(position_ns_, value.stamp_ns);
    const bool fresh = has_velocity_ && value.stamp_ns - velocity_ns_ < std::int64_t{100'000'000};
    if (value.position_reason != hal::Reason::ok || !fresh) {
        has_position_ = false;
        return;
    }
    if (has_position_ && step_s > 0 && step_s < longest_step_s) {
        add(0.5 * (velocity_ + last_velocity_) * step_s, value.position_rad - position_rad_, step_s);
    }
    position_ns_ = value.stamp_ns;
    position_rad_ = value.position_rad;
    last_velocity_ = velocity_;
    has_position_ = true;
}

void VelocityCheck::add(double expected_rad, double moved_rad, double step_s) noexcept {
    if (std::max(std::abs(expected_rad), std::abs(moved_rad)) < least_speed * step_s) {
        return;
    }
    ++steps_;
    velocities_ += expected_rad / step_s;
    velocity_squares_ += expected_rad / step_s * (expected_rad / step_s);
    expected_ += expected_rad;
    moved_ += moved_rad;
    squares_ += expected_rad * expected_rad;
    products_ += moved_rad * expected_rad;
    moved_squares_ += moved_rad * moved_rad;
    distance_rad_ += std::abs(moved_rad);
    expected_distance_rad_ += std::abs(expected_rad);
}

bool VelocityCheck::stands() const noexcept {
    constexpr double standing = 0.02;
    return distance_rad_ < standing * expected_distance_rad_;
}

/// A constant velocity with steps of different lengths contains no information.
bool VelocityCheck::varies() const noexcept {
    const double mean = velocities_ / std::max(steps_, 1.0);
    return velocity_squares_ - velocities_ * mean > least_variation * velocity_squares_;
}

double VelocityCheck::ratio() const noexcept {
    if (stands()) {
        return 0;
    }
    const double variance = squares_ - expected_ * expected_ / std::max(steps_, 1.0);
    const double covariance = products_ - expected_ * moved_ / std::max(steps_, 1.0);
    return variance > least_variation * squares_ ? covariance / variance : 1;
}

double VelocityCheck::ratio_error() const noexcept {
    const double variance = squares_ - expected_ * expected_ / std::max(steps_, 1.0);
    if (stands()) {
        return 0;
    }
    if (steps_ < 3 || variance <= least_variation * squares_) {
        return 1e9; // nothing is known
    }
    const double moved_variance = moved_squares_ - moved_ * moved_ / steps_;
    const double residual = std::max(moved_variance - ratio() * ratio() * variance, 0.0);
    return std::sqrt(residual / (steps_ - 2) / variance);
}

bool VelocityCheck::is_sure() const noexcept {
    return steps_ >= least_steps && (stands() || varies()) &&
           std::max(distance_rad_, expected_distance_rad_) >= least_distance_rad &&
           errors_to_be_sure * ratio_error() < std::max(std::abs(ratio()), largest_deviation);
}

bool VelocityCheck::is_unrelated() const noexcept {
    constexpr double more_than_noise_rad = 0.01; // mean step
    constexpr double least_correlation = 0.5;
    if (steps_ < least_steps || distance_rad_ < more_than_noise_rad * steps_ || !varies()) {
        return false;
    }
    const double variance = squares_ - expected_ * expected_ / steps_;
    const double moved_variance = moved_squares_ - moved_ * moved_ / steps_;
    const double covariance = products_ - expected_ * moved_ / steps_;
    return std::abs(covariance) < least_correlation * std::sqrt(std::max(variance * moved_variance, 0.0));
}

bool VelocityCheck::contradicts() const noexcept {
    const double deviation = std::abs(ratio() - 1);
    return is_sure() && deviation > largest_deviation && deviation > errors_to_be_sure * ratio_error();
}

} // namespace dfdyn::tools
