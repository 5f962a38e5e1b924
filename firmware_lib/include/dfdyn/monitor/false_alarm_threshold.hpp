// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn {

/// Adaptive CUSUM threshold: the level that sums of one kind exceed once per given number of blocks while no
/// change is on.
///
/// The excursions of a sum with negative drift have heights with an exponential tail, for any distribution of
/// the increments and any short correlation (Cramér-Lundberg bound: F. Lundberg, 1926; H. Cramér, 1930). For
/// log-likelihood ratios of the assumed noise the mean height above any base is 1. For the sums of a given
/// arm it is estimated from n heights above `base` with the sum E. The prior has the weight of `prior`
/// excursions of mean height `prior_mean`. The predictive probability that the next excursion exceeds base +
/// x is (1 + x/E)^-n, which includes the uncertainty of the mean.
///
/// Memory: three scalars. Cost of a limit: `limit_cost` multiply-adds.
template <class Scalar>
class FalseAlarmThreshold {
  public:
    static constexpr Scalar base = 4;
    static constexpr Scalar prior = 10;               ///< excursions …
    static constexpr Scalar prior_mean = Scalar(1.5); ///< … of this height, at the start
    static constexpr Scalar memory = 1000;            ///< excursions; then the weight of all is halved
    static constexpr Scalar most = 4;                 ///< mean heights; larger excursions are clamped

    static constexpr int limit_cost = 2 * function_cost + 5;

    /// Adds a completed excursion; `height` ≥ 0.
    void add(Scalar height) noexcept {
        if (height <= base) {
            return;
        }
        excess_ += std::min(height - base, most * mean());
        count_ += 1;
        if (count_ >= memory) {
            count_ /= 2;
            excess_ /= 2;
            blocks_ /= 2;
        }
    }
    void add_block() noexcept { blocks_ += 1; }

    /// Returns the level that all sums of the kind together exceed once in `blocks` > 1 on average.
    [[nodiscard]] Scalar limit(Scalar blocks) const noexcept {
        using std::exp;
        using std::log;
        const Scalar excursions = std::max(blocks * (count_ + 1) / (blocks_ + 1), Scalar(2));
        return base + (prior * prior_mean + excess_) * (exp(log(excursions) / (prior + count_)) - 1);
    }
    /// Returns the mean height above `base`.
    [[nodiscard]] Scalar mean() const noexcept { return (prior * prior_mean + excess_) / (prior + count_); }

  private:
    Scalar count_ = 0, excess_ = 0, blocks_ = 0;
};

} // namespace dfdyn
