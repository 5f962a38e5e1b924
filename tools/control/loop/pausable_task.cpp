// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/pausable_task.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

PausableTask::PausableTask(std::unique_ptr<Task> task, double period_s)
    : task_(std::move(task)), period_s_(period_s), before_(task_->next()), after_(task_->next()),
      offset_(JointVector::Zero(before_.position.size())) {}

void PausableTask::lead_in(const JointVector& offset, const JointVector& speed_limit) {
    constexpr double peak = 1.875; // of the polynomial's speed, relative to its mean
    JointVector speed = JointVector::Constant(offset.size(), lead_in_speed);
    if (speed_limit.size() > 0) {
        speed = speed.cwiseMin(lead_in_share * speed_limit);
    }
    offset_ = offset;
    lead_in_s_ = std::max(shortest_lead_in_s, peak * offset.cwiseAbs().cwiseQuotient(speed).maxCoeff());
    led_s_ = rate_ * period_s_;
}

Reference PausableTask::next() {
    Reference reference = leads_in() ? on_lead_in() : on_path();
    step_rate();
    if (leads_in()) {
        led_s_ += rate_ * period_s_;
        return reference;
    }
    phase_ += rate_;
    if (phase_ >= 1) {
        phase_ -= 1;
        before_ = std::exchange(after_, task_->next());
    }
    return reference;
}

void PausableTask::step_rate() {
    const double before = rate_;
    rate_ = pausing_ ? std::max(rate_ - period_s_ / pause_s, 0.0) : rate_;
    acceleration_ = (rate_ - before) / period_s_;
}

Reference PausableTask::on_lead_in() const {
    const SmoothStep step = smooth_step(led_s_, lead_in_s_);
    const double acceleration = rate_ * rate_ * step.acceleration + acceleration_ * step.rate;
    return {before_.position + (1 - step.value) * offset_, -rate_ * step.rate * offset_,
            -acceleration * offset_};
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

} // namespace dfdyn::tools
