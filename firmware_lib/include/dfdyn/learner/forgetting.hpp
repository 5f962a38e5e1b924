// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn {

/// Exponential forgetting that is limited by the excitation.
///
/// A factor λ discards log(1/λ) nats of information about each of p parameters with every sample. If a sample
/// contributes less, the covariance grows along all directions that the motion does not excite, without bound
/// at standstill (covariance wind-up). Forgetting is therefore paid from an account: each sample pays in
/// `payback` times the information log(1 + φ'Pφ) that it contributed, and forgetting is reduced to what the
/// account covers. While the motion excites at least 1/`payback` of the parameters, λ is applied exactly. A
/// standstill excites only as many directions as a sample has rows. `payback` is 20 but at most half of the
/// parameters per row (and at least 1): these directions then cannot pay for all others, and forgetting
/// stops. The learner bounds the remaining growth: per sample it checks the variance of one parameter and
/// reduces it to the prior's if it is larger.
///
/// A row that repeats forever contributes φ'Pφ = (1-λ)/λ under forgetting with λ, and less once the account
/// limits forgetting. A sample that contributes less than 1-λ per row is therefore attributed to a standstill
/// and pays nothing. Otherwise the log t that t such rows contribute would be discarded, `payback` times,
/// from the other parameters. A sample of m rows with few parameters, p < 2 m, pays from (1-λ) p / 2 on, half
/// of what a motion contributes.
///
/// A sample that contributes less than 1024 ε per row (ε: machine epsilon) also pays nothing. There φ'Pφ is
/// rounding error: it stops falling where one more row no longer changes the factor of P, and would pay
/// forever.
///
/// While the account is empty and samples pay nothing, the arm is `resting`: rows are still learned, but the
/// covariance stays as it is. Otherwise it would shrink along the row as 1/t. In float D would then stop
/// changing while U still did, and the variance of the other directions would grow. A target that changes at
/// rest is thus tracked within the memory, even after a long rest.
///
/// A moving arm forgets with λ as long as one row in `payback` contributes more than both limits. If the
/// memory is much longer than p / (1024 ε) samples (8000 p in float, 4·10¹² p in double), no row does, and
/// the memory becomes longer than λ specifies.
template <class Scalar>
class Forgetting {
  public:
    /// 1 - 1/`parameters` ≤ `factor` ≤ 1: a memory shorter than one sample per parameter determines none of
    /// them. `parameters` ≥ 1; `rows` per sample ≥ 1.
    constexpr Forgetting(Scalar factor, int parameters, int rows = 1) noexcept
        : factor_(factor), parameters_(static_cast<Scalar>(parameters)),
          payback_(std::clamp(parameters_ / (2 * static_cast<Scalar>(rows)), Scalar(1), Scalar(20))),
          least_paid_(
              std::max<Scalar>(static_cast<Scalar>(rows) * 1024 * std::numeric_limits<Scalar>::epsilon(),
                               std::min<Scalar>(static_cast<Scalar>(rows), parameters_ / 2) * (1 - factor))) {
        using std::log;
        price_ = active() ? parameters_ * -log(factor) : Scalar(0);
        restart();
    }

    [[nodiscard]] constexpr bool active() const noexcept { return factor_ < 1; }

    /// Fills the account: one horizon 1/(1-λ) of forgetting without excitation, in which variances grow by at
    /// most the factor e.
    constexpr void restart() noexcept {
        account_ = active() ? capacity() : Scalar(0);
        resting_ = 0;
        next_parameter_ = 0;
    }

    /// Returns the factor to apply, 0 < factor ≤ 1, after a sample with predictive variance `ratio` = 1 +
    /// φ'Pφ ≥ 1, in units of the noise variance.
    [[nodiscard]] Scalar factor_after(Scalar ratio) noexcept {
        if (!active()) {
            return 1;
        }
        using std::exp;
        using std::log;
        const bool pays = !(ratio - 1 < least_paid_);
        account_ += pays ? payback_ * log(ratio) : Scalar(0);
        account_ = account_ < capacity() ? account_ : capacity();
        resting_ = !pays && account_ <= 0 ? 1 : 0;
        if (account_ >= price_) {
            account_ -= price_;
            return factor_;
        }
        const Scalar affordable = exp(-account_ / parameters_);
        account_ = 0;
        return affordable;
    }

    /// Returns whether the account is empty and the last sample paid nothing: the arm is at rest.
    [[nodiscard]] constexpr bool resting() const noexcept { return resting_ != 0; }

    /// Maximum multiply-adds of `factor_after`.
    static constexpr int cost = 2 * (function_cost + 1);

    /// Returns the index of the parameter whose variance is checked next, in cyclic order.
    [[nodiscard]] constexpr int next_parameter() noexcept {
        const int parameter = next_parameter_;
        next_parameter_ = parameter + 1 < static_cast<int>(parameters_) ? parameter + 1 : 0;
        return parameter;
    }

    template <class Self, class Visitor>
    static constexpr void visit_state(Self& self, Visitor& visitor) noexcept {
        visitor.ranged(self.account_, Scalar(0), self.capacity());
        visitor.ranged(self.resting_, 0, 1);
        visitor.ranged(self.next_parameter_, 0, static_cast<int>(self.parameters_) - 1);
    }

  private:
    /// Capacity of the account in nats: one horizon of forgetting costs log(1/λ)/(1-λ) ≈ 1 nat per parameter.
    [[nodiscard]] constexpr Scalar capacity() const noexcept { return parameters_; }

    Scalar factor_;
    Scalar parameters_;
    Scalar payback_;
    Scalar least_paid_; ///< smallest φ'Pφ that pays
    Scalar price_ = 0;  ///< cost of applying the factor once, in nats
    Scalar account_ = 0;
    int resting_ = 0; ///< 1 at rest
    int next_parameter_ = 0;
};

} // namespace dfdyn
