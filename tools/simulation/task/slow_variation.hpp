// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"

namespace dfdyn::tools {

/// A slow and smooth random signal: white noise through two equal low-pass filters, so that its rate is
/// continuous. It starts at 0; after a few time constants its standard deviation is `size`.
class SlowVariation {
  public:
    SlowVariation(double size, double time_constant_s, double period_s);

    /// Advances by one step of `period_s`.
    void advance(NormalSource& source);

    double value() const noexcept { return value_; }
    double rate() const noexcept { return rate_; } ///< per second

  private:
    double size_;
    double left_; ///< decay factor of a low-pass filter's state per step
    double period_s_;
    double first_ = 0, second_ = 0;
    double value_ = 0, rate_ = 0;
};

} // namespace dfdyn::tools
