// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/joint_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dfdyn::tools {

JointWatch::JointWatch(SafeStopConfig config, double period_s)
    : config_(std::move(config)), period_s_(period_s) {
    const Eigen::Index joints = config_.following_error.size();
    const auto count = static_cast<std::size_t>(joints);
    speed_ = mean_velocity_ = lowest_ = highest_ = pressing_position_ = JointVector::Zero(joints);
    reading_ = JointVector::Constant(joints, std::numeric_limits<double>::quiet_NaN());
    same_.resize(count);
    stuck_.resize(count);
    fast_.resize(count);
    pressing_.resize(count);
    repeated_.resize(count);
}

void JointWatch::found(StopCause cause, Eigen::Index joint) noexcept {
    if (cause_ == StopCause::none) {
        cause_ = cause;
        joint_ = joint;
    }
}

bool JointWatch::must_have_moved(Eigen::Index joint, double tolerance) const noexcept {
    if (config_.acceleration.size() == 0) {
        return false;
    }
    constexpr double braking_share = 0.125; // of that acceleration: a quarter of the torque limit
    const double acceleration = braking_share * config_.acceleration[joint];
    const double time_s = std::min(period_s_ * same_[static_cast<std::size_t>(joint)],
                                   speed_[joint] / acceleration); // it may have stopped after this time
    return time_s * (speed_[joint] - acceleration * time_s / 2) > tolerance;
}

double JointWatch::steady_speed(Eigen::Index joint, double velocity) const noexcept {
    const double mean = mean_velocity_[joint];
    return velocity * mean > 0 ? std::min(std::abs(velocity), std::abs(mean)) : 0;
}

void JointWatch::repeat(Eigen::Index joint, double reference, const PositionFeedback& feedback) noexcept {
    const auto j = static_cast<std::size_t>(joint);
    const double count = feedback.smallest_step(joint);
    if (same_[j] == 0) {
        speed_[joint] = steady_speed(joint, feedback.velocity()[joint]);
    }
    same_[j] = counted(same_[j], most_same);
    lowest_[joint] = std::min(lowest_[joint], reference);
    highest_[joint] = std::max(highest_[joint], reference);
    const double given = feedback.given_noise_bound(), noise = given > 0 ? given : count;
    repeated_[j] = repeated_[j] || must_have_moved(joint, 2 * count + 4 * noise);
    const bool left = highest_[joint] - lowest_[joint] > std::max(config_.sticking[joint], 8 * count);
    stuck_[j] = repeated_[j] || left ? counted(stuck_[j], config_.frozen_patience) : 0;
    if (stuck_[j] > config_.frozen_patience) {
        found(StopCause::frozen_encoder, joint);
    }
}

void JointWatch::read(const JointVector& position, const JointVector& reference,
                      const PositionFeedback& feedback, const std::vector<bool>& missing) {
    constexpr double mean_readings = 10; // memory of the mean velocity
    for (Eigen::Index joint = 0; joint < position.size(); ++joint) {
        const auto j = static_cast<std::size_t>(joint);
        if (missing[j]) {
            continue;
        }
        mean_velocity_[joint] += (feedback.velocity()[joint] - mean_velocity_[joint]) / mean_readings;
        if (position[joint] == reading_[joint]) {
            repeat(joint, reference[joint], feedback);
            continue;
        }
        reading_[joint] = position[joint];
        lowest_[joint] = highest_[joint] = reference[joint];
        same_[j] = stuck_[j] = 0;
        repeated_[j] = false;
    }
}

void JointWatch::move(const PositionFeedback& feedback, const JointVector& command) {
    for (Eigen::Index joint = 0; joint < command.size(); ++joint) {
        const auto j = static_cast<std::size_t>(joint);
        const double position = feedback.position()[joint];
        if (feedback.observed(joint) && config_.speed_limit.size() > 0) {
            const bool fast = std::abs(feedback.velocity()[joint]) > config_.speed_limit[joint];
            fast_[j] = fast ? counted(fast_[j], config_.speed_patience) : 0;
        }
        const bool presses = config_.torque_limit.size() > 0 &&
                             std::abs(command[joint]) >= 0.999 * config_.torque_limit[joint];
        const bool moved =
            std::abs(position - pressing_position_[joint]) > config_.following_error[joint] / 10;
        pressing_[j] = presses && !moved ? counted(pressing_[j], config_.pressing_ticks) : 0;
        if (pressing_[j] == 0) {
            pressing_position_[joint] = position;
        }
        if (fast_[j] > config_.speed_patience) {
            found(StopCause::overspeed, joint);
        }
        if (pressing_[j] > config_.pressing_ticks) {
            found(StopCause::torque_limit, joint);
        }
    }
}

} // namespace dfdyn::tools
