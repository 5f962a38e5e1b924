// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/control/feed_forward.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace dfdyn {

/// Two learners of the same joints as one `TorqueLearner` with the forecasts of both, which `FeedForward`
/// weights. Example: model SPK with a memory of many seconds, and model P with a memory of a second and an
/// innovation patience of 0. P adapts quickly to a change of the arm; SPK is more accurate otherwise.
///
/// Refers to both learners, which must outlive it and have the same sample period. Either may be a pair
/// itself. The cost of a tick is the sum of both. Never allocates.
template <TorqueLearner First, TorqueLearner Second>
class LearnerPair {
  public:
    using Scalar = typename First::Scalar;                                     ///< float or double
    static constexpr int outputs = First::outputs;                             ///< n: one torque per joint
    static constexpr int forecasts = sum(First::forecasts, Second::forecasts); ///< of both
    static_assert(std::is_same_v<Scalar, typename Second::Scalar> && outputs == Second::outputs,
                  "both learners must have the same joints and scalar");

    /// Refers to `first` and `second`.
    LearnerPair(First& first, Second& second) noexcept : first_(&first), second_(&second) {}

    /// Returns the number of torques of a forecast, n.
    [[nodiscard]] Extent<outputs> output_count() const noexcept { return first_->output_count(); }
    /// Returns the number of forecasts.
    [[nodiscard]] Extent<forecasts> forecast_count() const noexcept {
        return extent<forecasts>(first_->forecast_count() + second_->forecast_count());
    }

    /// See `LearnedTorque::begin`.
    void begin(std::int64_t time_ns, const Scalar* position) noexcept {
        first_->begin(time_ns, position);
        second_->begin(time_ns, position);
    }
    /// See `LearnedTorque::learn`. The learners' counters contain the refused samples.
    void learn(std::int64_t time_ns, const Scalar* position, const Scalar* torque) noexcept {
        first_->learn(time_ns, position, torque);
        second_->learn(time_ns, position, torque);
    }
    /// Continues to learn the sample. Call it in every control tick without a new sample.
    void go_on() noexcept {
        first_->go_on();
        second_->go_on();
    }

    /// Writes the forecasts of both, `forecast_count()` × n torques, N·m; NaN for a learner without a
    /// prediction. Returns false if neither has one. Arguments: see `LearnedTorque::predict`.
    bool predict(std::int64_t time_ns, const Scalar* position, Scalar* torque) noexcept {
        const int size = first_->forecast_count() * output_count();
        const int second_size = second_->forecast_count() * output_count();
        Scalar* const second = torque + size;
        const bool first_known = first_->predict(time_ns, position, torque);
        const bool second_known = second_->predict(time_ns, position, second);
        constexpr Scalar unknown = std::numeric_limits<Scalar>::quiet_NaN();
        std::fill_n(torque, first_known ? 0 : size, unknown);
        std::fill_n(second, second_known ? 0 : second_size, unknown);
        return first_known || second_known;
    }

  private:
    First* first_;
    Second* second_;
};

} // namespace dfdyn
