// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <algorithm>

namespace dfdyn {

/// Range of a prediction's error that the hysteresis of a joint's dry friction explains, in units of the
/// friction.
///
/// Dry friction follows the displacement: after a reversal it changes its sign over `presliding`, and a joint
/// that stops keeps it (Maxwell-slip element). A model computes it from a velocity. The two differ at rest,
/// where the velocity tends to zero, after a reversal, because a velocity from positions is late, and where
/// single counts of an encoder change the sign of the velocity. The range is from zero to their difference,
/// after the two poles of a filter.
template <class Scalar>
class FrictionHysteresis {
  public:
    static constexpr Scalar presliding = Scalar(0.001); ///< rad, displacement of half a change of sign
    static constexpr Scalar lag_s = Scalar(0.03);       ///< time constant of each pole of the velocity, s

    /// Starts at rest without friction.
    void begin() noexcept { *this = {}; }

    /// Updates the range. `displacement`: rad, since the last tick. `direction`: of the velocity, from -1 to
    /// 1, where a model predicts the whole friction. `lag` and `filter`: shares of the
    /// present values in the filters of the velocity and of the range.
    void follow(Scalar displacement, Scalar direction, Scalar lag, Scalar filter) noexcept {
        friction_ = std::clamp(friction_ + displacement / presliding, Scalar(-1), Scalar(1));
        first_lag_ += lag * (direction - first_lag_);
        predicted_ += lag * (first_lag_ - predicted_);
        const Scalar difference = friction_ - predicted_;
        first_low_ += filter * (std::min(difference, Scalar(0)) - first_low_);
        first_high_ += filter * (std::max(difference, Scalar(0)) - first_high_);
        low_ += filter * (first_low_ - low_);
        high_ += filter * (first_high_ - high_);
    }

    /// Returns the lower end, from -2 to 0.
    [[nodiscard]] Scalar low() const noexcept { return low_; }
    /// Returns the upper end, from 0 to 2.
    [[nodiscard]] Scalar high() const noexcept { return high_; }

  private:
    Scalar friction_ = 0;
    Scalar first_lag_ = 0, predicted_ = 0;
    Scalar first_low_ = 0, low_ = 0;
    Scalar first_high_ = 0, high_ = 0;
};

} // namespace dfdyn
