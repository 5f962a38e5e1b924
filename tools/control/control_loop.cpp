// SPDX-License-Identifier: Apache-2.0
#include "tools/control/control_loop.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

ControlLoop::ControlLoop(LoopConfig config, FeedForward feed_forward, std::unique_ptr<Task> task)
    : config_(std::move(config)), feed_forward_(std::move(feed_forward)),
      feedback_(config_.gains, config_.filter, config_.period_s), safe_stop_(config_.safe_stop),
      task_(std::move(task)), zero_(JointVector::Zero(config_.torque_limit.size())), command_(zero_),
      last_followed_(zero_) {
    references_.resize(static_cast<std::size_t>(config_.knot_ticks + 1 + config_.delay_ticks));
    for (int i = 0; i <= config_.knot_ticks; ++i) {
        references_[static_cast<std::size_t>(i)] = task_->next();
    }
}

const Reference& ControlLoop::measured_reference() const noexcept {
    const std::size_t delay = std::min(tick_, static_cast<std::size_t>(config_.delay_ticks));
    return references_[(tick_ - delay) % references_.size()];
}

const JointVector& ControlLoop::tick(const LoopInput& input) {
    ++counters_.ticks;
    counters_.missed_deadlines += input.deadline_missed ? 1 : 0;
    if (state() == LoopState::running) { // the reference goes on with the time
        ++tick_;
        references_[(tick_ + static_cast<std::size_t>(config_.knot_ticks)) % references_.size()] =
            task_->next();
    }
    sense(input);
    const bool seen = feedback_.position().size() > 0;
    const JointVector error =
        seen ? JointVector(measured_reference().position - feedback_.position()) : zero_;
    const LoopState state = safe_stop_.tick(
        {input.position != nullptr, input.deadline_missed, input.bus_lost, input.stop_requested}, error);
    if (state == LoopState::running) {
        follow(input);
    } else if (state != LoopState::waiting && moved()) {
        hold();
    }
    limit();
    return command_;
}

void ControlLoop::sense(const LoopInput& input) {
    if (input.position != nullptr) {
        feedback_.observe(*input.position);
    } else if (state() == LoopState::running) {
        feedback_.coast();
        ++counters_.coasted;
    }
}

void ControlLoop::follow(const LoopInput& input) {
    const auto knot_ticks = static_cast<std::size_t>(config_.knot_ticks);
    const std::size_t since_knot = tick_ % knot_ticks;
    if (!moved()) {
        feed_forward_.begin(input.time_ns, reference());
    }
    ++counters_.running;
    if (since_knot == 0) {
        if (input.position != nullptr && input.torque != nullptr) {
            feed_forward_.measured(input.time_ns, *input.position, *input.torque);
        }
        const auto ahead_ns =
            static_cast<std::int64_t>(std::llround(static_cast<double>(knot_ticks) * config_.period_s * 1e9));
        feed_forward_.advance(input.time_ns + ahead_ns,
                              references_[(tick_ + knot_ticks) % references_.size()]);
    }
    const double share = static_cast<double>(since_knot) / static_cast<double>(knot_ticks);
    command_ = feed_forward_.torque(share) + feedback_.torque(measured_reference());
    last_followed_ = command_;
}

void ControlLoop::hold() {
    const bool fresh = safe_stop_.cause() != StopCause::no_position;
    const JointVector damping =
        fresh ? JointVector(config_.gains.velocity.cwiseProduct(feedback_.velocity())) : zero_;
    const JointVector holding = feed_forward_.gravity(feedback_.position()) - damping;
    command_ = last_followed_ + safe_stop_.hold_share() * (holding - last_followed_);
}

void ControlLoop::limit() {
    const JointVector& most = config_.torque_limit;
    counters_.limited += (command_.array().abs() > most.array()).any() ? 1 : 0;
    command_ = command_.cwiseMin(most).cwiseMax(-most);
}

} // namespace dfdyn::tools
