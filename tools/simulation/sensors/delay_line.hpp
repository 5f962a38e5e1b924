// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <vector>

namespace dfdyn::tools {

/// Delays the elements of a signal that is sampled in constant steps, fractions of a step by linear
/// interpolation. `Vector`: an Eigen column vector of doubles.
template <class Vector>
class DelayLine {
  public:
    /// `delay_steps`: delay of each element in steps, 0 or more.
    explicit DelayLine(const Vector& delay_steps) : delay_steps_(delay_steps) {}

    /// Adds the value of the next step. The first call starts as if the signal had always had this value.
    void push(const Vector& value) {
        if (past_.empty()) {
            past_.assign(static_cast<std::size_t>(delay_steps_.maxCoeff()) + 2, value);
        }
        newest_ = (newest_ + 1) % past_.size();
        past_[newest_] = value;
    }

    /// Returns the delayed signal at the last step; `push` must have been called before.
    Vector delayed() const {
        Vector result = delay_steps_;
        for (Eigen::Index i = 0; i < result.size(); ++i) {
            const auto whole = static_cast<std::size_t>(delay_steps_[i]);
            const double fraction = delay_steps_[i] - std::floor(delay_steps_[i]);
            const double later = past(whole)[i];
            result[i] = later + fraction * (past(whole + 1)[i] - later);
        }
        return result;
    }

  private:
    const Vector& past(std::size_t steps) const {
        return past_[(newest_ + past_.size() - steps) % past_.size()];
    }

    Vector delay_steps_;
    std::vector<Vector> past_; ///< ring of the steps that the largest delay needs
    std::size_t newest_ = 0;
};

} // namespace dfdyn::tools
