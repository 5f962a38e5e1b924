// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"

namespace dfdyn::tools {

/// A random signal that wanders slowly and smoothly: white noise through two equal low passes, so that it has
/// a continuous rate. Starts at 0; after a few times its time constant its standard deviation is `size`.
class SlowVariation {
  public:
    SlowVariation(double size, double time_constant_s, double period_s);

    /// One step of `period_s`.
    void advance(NormalSource& source);

    double value() const noexcept { return value_; }
    double rate() const noexcept { return rate_; } ///< per second

  private:
    double size_;
    double left_; ///< of a low pass's state after one step
    double period_s_;
    double first_ = 0, second_ = 0;
    double value_ = 0, rate_ = 0;
};

} // namespace dfdyn::tools
