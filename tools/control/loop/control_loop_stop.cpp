// SPDX-License-Identifier: Apache-2.0
// The stop of a ControlLoop: braking, holding, brakes and end.
#include "tools/control/loop/control_loop.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

/// Returns whether the last output of feedback and observer is unreliable because something blocked the arm
/// or a reading was wrong.
bool opposed(StopCause cause, const std::optional<TakenAction>& stop) {
    const bool pushed = cause == StopCause::finding && stop &&
                        (stop->cause == Cause::contact || stop->cause == Cause::frozen);
    return pushed || cause == StopCause::following_error || cause == StopCause::torque_limit ||
           cause == StopCause::frozen_encoder;
}

} // namespace

void ControlLoop::hold() {
    request_brakes();
    released_ = released_ || releases();
    const JointVector wanted = released_ ? zero_ : holding_torque();
    command_ = slowly(wanted);
    limit();
    excess_ = wanted - command_;
}

void ControlLoop::begin_braking(Eigen::Index joint) {
    const PositionFeedback::JointMotion motion = feedback_.believed_motion(joint);
    braking_.position[joint] = motion.position;
    braking_.velocity[joint] = motion.velocity;
    braking_.acceleration[joint] = -motion.velocity / stop_time_s;
}

void ControlLoop::brake() {
    if (braking_.position.size() == 0) {
        braking_ = {zero_, zero_, zero_};
        feedback_.hold_reference(measured_reference().position);
        for (Eigen::Index joint = 0; joint < zero_.size(); ++joint) {
            begin_braking(joint);
        }
    }
    for (Eigen::Index joint = 0; joint < zero_.size(); ++joint) {
        const auto j = static_cast<std::size_t>(joint);
        // readings have returned, or a jump has become the position
        if (damped(joint) && (blind_[j] || (unsettled_[j] && feedback_.jumped(joint)))) {
            begin_braking(joint);
        }
        blind_[j] = !heard(joint);
        unsettled_[j] = !feedback_.settled(joint);
        const double before = braking_.velocity[joint];
        const double after = before + config_.period_s * braking_.acceleration[joint];
        if (after * before <= 0) {
            braking_.velocity[joint] = braking_.acceleration[joint] = 0;
        } else {
            braking_.position[joint] += config_.period_s * (before + after) / 2;
            braking_.velocity[joint] = after;
        }
    }
}

JointVector ControlLoop::holding_torque() {
    brake();
    Reference where = braking_; // reference at the measured position
    for (Eigen::Index joint = 0; joint < zero_.size(); ++joint) {
        where.position[joint] = damped(joint) ? feedback_.position()[joint] : where.position[joint];
    }
    JointVector torque = feed_forward_.holding(where);
    const JointVector feedback = braking_feedback();
    if (!touched_ && !opposed(safe_stop_.cause(), actions_.stop())) {
        torque += braking_disturbance(feedback);
    }
    return torque + feedback.unaryExpr([](double part) { return std::isnan(part) ? 0 : part; });
}

JointVector ControlLoop::braking_feedback() const {
    JointVector torque = zero_;
    for (Eigen::Index joint = 0; joint < torque.size(); ++joint) {
        const double most = spring_share * config_.torque_limit[joint];
        const double spring = std::max(0.0, config_.gains.position[joint]) *
                              (braking_.position[joint] - feedback_.position()[joint]);
        const double damping = std::max(0.0, config_.gains.velocity[joint]) *
                               (braking_.velocity[joint] - feedback_.velocity()[joint]);
        torque[joint] = damped(joint) ? std::clamp(spring, -most, most) + damping : unknown_torque;
    }
    return torque;
}

JointVector ControlLoop::braking_disturbance(const JointVector& feedback) {
    if (!brake_tick_) { // afterwards it would push against closed brakes
        const JointVector regular = of_regular_joints(feedback),
                          rate = braking_.velocity - feedback_.velocity();
        observer_.update(regular.data(), feed_forward_.inertia().data(), rate.data(), excess_.data());
    }
    JointVector torque = joint_vector(observer_.lasting());
    for (Eigen::Index joint = 0; joint < torque.size(); ++joint) {
        const bool moves = !brake_tick_ && damped(joint) && feedback_.regular(joint);
        torque[joint] = moves ? observer_.estimate()[static_cast<int>(joint)] : torque[joint];
    }
    return torque;
}

void ControlLoop::request_brakes() {
    constexpr double rest_speed = 0.05; // rad/s, m/s
    if (brake_tick_) {
        return;
    }
    bool blind = false, rests = true;
    for (Eigen::Index joint = 0; joint < zero_.size(); ++joint) {
        blind = blind || !heard(joint);
        rests = rests && damped(joint) && std::abs(feedback_.velocity()[joint]) <= rest_speed;
    }
    const bool stopped = state() == LoopState::stopped;
    stopped_tick_ = stopped && !stopped_tick_ ? counters_.ticks : stopped_tick_;
    const double waited_s =
        stopped ? config_.period_s * static_cast<double>(counters_.ticks - *stopped_tick_) : 0;
    if (blind || (stopped && (rests || waited_s >= brake_timeout_s))) {
        brake_tick_ = counters_.ticks;
    }
}

bool ControlLoop::brakes_closed() const noexcept {
    return brake_tick_ &&
           counters_.ticks - *brake_tick_ >= static_cast<std::uint64_t>(config_.safe_stop.brake_ticks);
}

bool ControlLoop::limp() const noexcept {
    return config_.safe_stop.mode == StopMode::limp && state() == LoopState::stopped && brakes_closed();
}

bool ControlLoop::releases() const noexcept {
    const double silent_s = config_.period_s * static_cast<double>(counters_.ticks - position_tick_);
    const bool over = told_ || limp() || silent_s >= give_up_s;
    return state() == LoopState::stopped && brakes_closed() && over;
}

bool ControlLoop::done() const noexcept {
    return state() == LoopState::stopped && (!moved() || (released_ && command_.isZero(0)));
}

} // namespace dfdyn::tools
