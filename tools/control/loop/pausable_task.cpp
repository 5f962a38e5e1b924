// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/pausable_task.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

PausableTask::PausableTask(std::unique_ptr<Task> task, double period_s)
    : task_(std::move(task)), period_s_(period_s), before_(task_->next()), after_(task_->next()) {}

Reference PausableTask::next() {
    Reference reference = on_path();
    add_distance(reference);
    step_rate();
    phase_ += rate_;
    if (phase_ >= 1) {
        phase_ -= 1;
        before_ = std::exchange(after_, task_->next());
    }
    return reference;
}

void PausableTask::pause() {
    pausing_ = true;
    if (distance_.size() > 0) {
        distance_ *= 1 - smooth_step(since_s_, return_s_).value;
        since_s_ = return_s_ = 0; // the distance stays
    }
}

void PausableTask::resume(const JointVector& position) {
    constexpr double seconds_per_rad = 4; // peak of the polynomial's rate: 1.875 / duration
    pausing_ = false;
    rate_ = acceleration_ = 0;
    distance_ = JointVector();
    distance_ = position - on_path().position;
    since_s_ = 0;
    return_s_ = std::max(continue_s, seconds_per_rad * distance_.cwiseAbs().maxCoeff());
}

void PausableTask::step_rate() {
    const double before = rate_;
    if (pausing_) {
        rate_ = std::max(rate_ - period_s_ / pause_s, 0.0);
    } else if (return_s_ > 0) {
        since_s_ += period_s_;
        rate_ = smooth_step(since_s_, return_s_).value;
        if (since_s_ >= return_s_) {
            rate_ = 1;
            return_s_ = 0;
            distance_ = JointVector();
        }
    }
    acceleration_ = (rate_ - before) / period_s_;
}

Reference PausableTask::on_path() const {
    const double s = phase_;
    if (s == 0 && rate_ == 1 && acceleration_ == 0) {
        return before_;
    }
    const double from = (1 + 2 * s) * (1 - s) * (1 - s), to = s * s * (3 - 2 * s);
    const double from_rate = s * (1 - s) * (1 - s) * period_s_, to_rate = s * s * (s - 1) * period_s_;
    const JointVector velocity = (1 - s) * before_.velocity + s * after_.velocity;
    const JointVector acceleration = (1 - s) * before_.acceleration + s * after_.acceleration;
    return {from * before_.position + to * after_.position + from_rate * before_.velocity +
                to_rate * after_.velocity,
            rate_ * velocity, rate_ * rate_ * acceleration + acceleration_ * velocity};
}

void PausableTask::add_distance(Reference& reference) const {
    if (distance_.size() == 0) {
        return;
    }
    const SmoothStep step = return_s_ > 0 ? smooth_step(since_s_, return_s_) : SmoothStep{0, 0, 0};
    reference.position += (1 - step.value) * distance_;
    reference.velocity -= step.rate * distance_;
    reference.acceleration -= step.acceleration * distance_;
}

} // namespace dfdyn::tools
