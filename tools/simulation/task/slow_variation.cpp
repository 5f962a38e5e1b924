// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/task/slow_variation.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

SlowVariation::SlowVariation(double size, double time_constant_s, double period_s)
    : size_(size), left_(std::exp(-period_s / time_constant_s)), period_s_(period_s) {}

void SlowVariation::advance(NormalSource& source) {
    first_ = left_ * first_ + std::sqrt(1 - left_ * left_) * source.next();
    second_ = left_ * second_ + (1 - left_) * first_;
    // the second low pass halves the variance
    const double value = size_ * std::numbers::sqrt2 * second_;
    rate_ = (value - value_) / period_s_;
    value_ = value;
}

} // namespace dfdyn::tools
