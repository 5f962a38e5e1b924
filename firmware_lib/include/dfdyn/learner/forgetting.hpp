// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/budget.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn {

/// Exponential forgetting that cannot outrun the excitation.
///
/// A factor λ < 1 gives away log(1/λ) nats of information about every one of p parameters with every sample;
/// a sample that brings less makes the covariance grow along everything the motion does not touch, without
/// bound while the arm stands still. So forgetting is paid for from an account: each sample pays in `payback`
/// times the information log(1 + φ'Pφ) that it brought, and forgetting is reduced to what the account covers.
/// While the motion excites at least 1/`payback` of the parameters, λ is applied exactly. A standstill
/// excites as many directions as an instant has rows; so that these do not pay for all others, `payback` is
/// 20 but at most half of the parameters per row (and at least 1), and forgetting stops by itself. What grows
/// nevertheless is bounded by the learner, which looks at one parameter per sample and takes its variance
/// back to the prior's.
///
/// A row that repeats for ever brings φ'Pφ = (1-λ)/λ under forgetting at λ, and less once the account limits
/// forgetting. So an instant that brings less than 1-λ per row belongs to a standstill, and pays nothing:
/// otherwise the log t that t such rows bring would be taken, `payback` times, from the other parameters. An
/// instant of m rows about few parameters, p < 2 m, pays from (1-λ) p / 2 on, half of what a motion brings.
/// Nor does an instant pay that brings less than 1024 ε per row: there φ'Pφ is rounding, which stops falling
/// where one more row no longer changes the factor of P, and would pay for ever. What such rows teach is
/// learned all the same. A moving arm forgets at λ as long as one row in `payback` brings more than both;
/// where the memory is well beyond p / (1024 ε) samples (8000 p in float, 4·10¹² p in double), none does, and
/// the memory becomes longer than λ says.
template <class Scalar>
class Forgetting {
  public:
    /// 1 - 1/`parameters` ≤ `factor` ≤ 1: a shorter memory than one sample per parameter determines none of
    /// them. `parameters` ≥ 1, `rows` ≥ 1 in an instant.
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

    /// A full account: one horizon 1/(1-λ) of forgetting without excitation, which lets variances grow by at
    /// most e.
    constexpr void restart() noexcept {
        account_ = active() ? capacity() : Scalar(0);
        next_parameter_ = 0;
    }

    /// The factor to apply after a sample whose predictive variance was `ratio` = 1 + φ'Pφ times the noise's.
    [[nodiscard]] Scalar factor_after(Scalar ratio) noexcept {
        if (!active()) {
            return 1;
        }
        using std::exp;
        using std::log;
        account_ += ratio - 1 < least_paid_ ? Scalar(0) : payback_ * log(ratio);
        account_ = account_ < capacity() ? account_ : capacity();
        if (account_ >= price_) {
            account_ -= price_;
            return factor_;
        }
        const Scalar affordable = exp(-account_ / parameters_);
        account_ = 0;
        return affordable;
    }

    /// Multiply-adds of `factor_after`, at most.
    static constexpr int cost = 2 * (function_cost + 1);

    /// The parameters in turn, for the look at their variances.
    [[nodiscard]] constexpr int next_parameter() noexcept {
        const int parameter = next_parameter_;
        next_parameter_ = parameter + 1 < static_cast<int>(parameters_) ? parameter + 1 : 0;
        return parameter;
    }

    template <class Self, class Visitor>
    static constexpr void visit_state(Self& self, Visitor& visitor) noexcept {
        visitor.ranged(self.account_, Scalar(0), self.capacity());
        visitor.ranged(self.next_parameter_, 0, static_cast<int>(self.parameters_) - 1);
    }

  private:
    /// log(1/λ)/(1-λ) ≈ 1 nat per parameter: what one horizon of forgetting costs.
    [[nodiscard]] constexpr Scalar capacity() const noexcept { return parameters_; }

    Scalar factor_;
    Scalar parameters_;
    Scalar payback_;
    Scalar least_paid_; ///< of φ'Pφ
    Scalar price_ = 0;  ///< of applying the factor once, in nats
    Scalar account_ = 0;
    int next_parameter_ = 0;
};

} // namespace dfdyn
