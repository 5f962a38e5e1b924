// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/sensors/derivative_estimator.hpp"

#include "dfdyn/input/adaptive_window.hpp"

#include <algorithm>

namespace dfdyn::tools {

DerivativeEstimator::DerivativeEstimator(const DerivativeModel& model, int joint_count, double period_s)
    : model_(model), joint_count_(joint_count),
      longest_(std::max(model.velocity_window, model.acceleration_window)),
      value_(static_cast<std::size_t>(longest_ * joint_count)) {
    for (int i = 0; i < longest_; ++i) {
        time_.push_back(-period_s * i);
    }
}

void DerivativeEstimator::observe(const JointVector& reading) {
    for (int joint = 0; joint < joint_count_; ++joint) {
        double* const first = value_.data() + joint * longest_;
        std::copy_backward(first, first + longest_ - 1, first + longest_);
        *first = reading[joint];
    }
    held_ = std::min(held_ + 1, longest_);
}

JointVector DerivativeEstimator::velocity() const {
    const int count = std::min(held_, model_.velocity_window);
    JointVector result(joint_count_);
    for (int joint = 0; joint < joint_count_; ++joint) {
        const double* const values = value_.data() + joint * longest_;
        result[joint] = AdaptiveWindow<double>(time_.data(), values, 1, count, model_.noise_bound).velocity();
    }
    return result;
}

JointVector DerivativeEstimator::acceleration() const {
    const int count = std::min(held_, model_.acceleration_window);
    JointVector result(joint_count_);
    for (int joint = 0; joint < joint_count_; ++joint) {
        const double* const values = value_.data() + joint * longest_;
        result[joint] =
            AdaptiveWindow<double>(time_.data(), values, 1, count, model_.noise_bound).acceleration();
    }
    return result;
}

} // namespace dfdyn::tools
