// SPDX-License-Identifier: Apache-2.0
#include "tools/control/position_feedback.hpp"

#include <utility>

namespace dfdyn::tools {

PositionFeedback::PositionFeedback(FeedbackGains gains, const DerivativeModel& filter, double period_s)
    : gains_(std::move(gains)), period_s_(period_s),
      filter_(filter, static_cast<int>(gains_.position.size()), period_s) {}

void PositionFeedback::observe(const JointVector& position) {
    position_ = position;
    filter_.observe(position);
    velocity_ = filter_.velocity();
}

void PositionFeedback::coast() { observe(position_ + period_s_ * velocity_); }

JointVector PositionFeedback::torque(const Reference& reference) const {
    return gains_.position.cwiseProduct(reference.position - position_) +
           gains_.velocity.cwiseProduct(reference.velocity - velocity_);
}

} // namespace dfdyn::tools
