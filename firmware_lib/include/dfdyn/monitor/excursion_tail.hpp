// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/budget.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn {

/// From how far a kind of sums rises while nothing happens, the limit that it exceeds once in so many blocks.
///
/// A sum that falls on average has excursions whose heights have an exponential tail, whatever the
/// distribution of what is summed and however it is correlated over short times (the bound of Cramér and
/// Lundberg: F. Lundberg, 1926; H. Cramér, 1930). Its mean height above any base is 1 for log likelihood
/// ratios of a noise that is as assumed; what it is for this arm's sums, is estimated from their heights
/// above `base`: n of them with the sum E, `prior` of the mean height `prior_mean` at the start as if seen
/// already. The next is then predicted to exceed base + x with probability (1 + x/E)^-n, which allows for
/// what is not known of the mean.
///
/// Three scalars; a limit takes `limit_cost` multiply-adds.
template <class Scalar>
class ExcursionTail {
  public:
    static constexpr Scalar base = 4;
    static constexpr Scalar prior = 10;               ///< excursions …
    static constexpr Scalar prior_mean = Scalar(1.5); ///< … of this height, at the start
    static constexpr Scalar memory = 1000;            ///< excursions; then all of them count half
    static constexpr Scalar most = 4;                 ///< mean heights that one excursion counts at most

    static constexpr int limit_cost = 2 * function_cost + 5;

    /// An excursion that is over; `height` ≥ 0.
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

    /// What is exceeded once in `blocks` > 1 on average, all sums of the kind together.
    [[nodiscard]] Scalar limit(Scalar blocks) const noexcept {
        using std::exp;
        using std::log;
        const Scalar excursions = std::max(blocks * (count_ + 1) / (blocks_ + 1), Scalar(2));
        return base + (prior * prior_mean + excess_) * (exp(log(excursions) / (prior + count_)) - 1);
    }
    /// Mean height above `base`.
    [[nodiscard]] Scalar mean() const noexcept { return (prior * prior_mean + excess_) / (prior + count_); }

  private:
    Scalar count_ = 0, excess_ = 0, blocks_ = 0;
};

} // namespace dfdyn
