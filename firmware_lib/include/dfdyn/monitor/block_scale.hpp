// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace dfdyn {

/// How large a signal's block means usually are, and how like the one before: their scale and first-order
/// autocorrelation, learned online.
///
/// The scale is that of Student's t with ν = `degrees` degrees of freedom, by stochastic approximation of its
/// likelihood equation E[(ν+1) u² / (ν + u²)] = 1 (K. L. Lange, R. J. A. Little and J. M. G. Taylor, "Robust
/// statistical modeling using the t distribution", 1989): what a robot does not predict has heavy tails, as
/// at every reversal of a joint, and no block counts for more than ν+1. The gain of block n is 4/n, then
/// 1/`memory`. A dozen operations per block; five scalars.
template <class Scalar>
class BlockScale {
  public:
    static constexpr Scalar degrees = 2;
    static constexpr Scalar memory = 600; ///< blocks
    static constexpr Scalar most_alike =
        Scalar(0.95); ///< autocorrelation: beyond, a block would tell nothing

    void learn(Scalar mean) noexcept {
        if (blocks_ == 0) {
            square_ = std::max(mean * mean, least);
        }
        blocks_ = std::min(blocks_ + 1, 4 * memory);
        const Scalar gain = std::max(1 / memory, 4 / (blocks_ + 8));
        const Scalar share = mean * mean / square_;
        square_ = std::max(square_ * (1 + gain * ((degrees + 1) * share / (degrees + share) - 1)), least);
        const Scalar now = std::clamp(mean / scale(), -clip, clip);
        power_ += gain * (now * now - power_);
        product_ += gain * (now * last_ - product_);
        last_ = now;
    }

    /// Takes the signal to have changed for good: it is learned anew, from where it is.
    void restart() noexcept { blocks_ = std::min(blocks_, Scalar(10)); }

    [[nodiscard]] Scalar scale() const noexcept { return std::sqrt(square_); }
    /// 0 … `most_alike`.
    [[nodiscard]] Scalar autocorrelation() const noexcept {
        return power_ > 0 ? std::clamp(product_ / power_, Scalar(0), most_alike) : Scalar(0);
    }

  private:
    static constexpr Scalar least = Scalar(1e-12); ///< square of a scale
    static constexpr Scalar clip = 3;              ///< scales: what one block may say of autocorrelation

    Scalar square_ = 1;
    Scalar power_ = 0, product_ = 0, last_ = 0;
    Scalar blocks_ = 0;
};

} // namespace dfdyn
