// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"

namespace dfdyn {

/// Measured properties of the outputs for predictions away from the data; `dfdyn train` computes them. If all
/// are zero or absent, predictions and standard deviations are those of the paper.
template <class Scalar, int m>
struct ExtrapolationConstants {
    /// 1 / (trace(P) / 2d) with the initial P: inverse of the variance φ'Pφ far from the data, in units of
    /// the noise variance. 0 for a model without features.
    Scalar inverse_far_variance = 0;
    /// variance near the data beyond the noise, in units of the noise variance; ≥ 0
    Storage<Scalar, m> extra_noise{};
    /// prior variance of the features' part of an output, in units of the noise variance
    Storage<Scalar, m> prior_variance{};
    /// Factor on the variance of the physics' parameters: the number of correlated samples that carry the
    /// information of one sample with white noise. ≥ 1; 0: not measured, the factor is 1.
    Scalar parameter_variance_factor = 0;
    /// Prior variance of each output about its offset, in units of the noise variance; used with
    /// `parameter_variance_factor`.
    Storage<Scalar, m> output_variance{};

    /// Returns whether `dfdyn train` measured these constants; otherwise predictions are the paper's.
    [[nodiscard]] constexpr bool measured() const noexcept {
        return inverse_far_variance > 0 || parameter_variance_factor > 0;
    }
};

/// Reduction of a prediction, and growth of its variance, at one φ away from the data.
///
/// The novelty t = φ'Pφ / (its value far from all data), at most 1, is near 0 close to the data and 1 where
/// no learned row resembles φ. There the features' part of the prediction is noise as large as the weights:
/// unlike a kernel, finitely many features never fade out. That part is therefore multiplied by 1 / (1 +
/// (2t)^6), which is 1 to single precision below t = 0.03, 0.996 at 0.2, and 0.015 at 1. The variance of its
/// error is the output's prior variance times 4t / (1 + 3t): the odds of novelty are multiplied by four,
/// because residuals of real arms are correlated in time and carry less information than independent ones.
/// Form and constants were chosen on two motions of one measured arm and on a servo (see
/// docs/reference/extrapolation.md).
///
/// For the same reason the variance of the physics' parameters is multiplied by `parameter_variance_factor`.
/// Where the data have not determined the physics, this variance exceeds the range of the output. A
/// prediction is multiplied by 1 / (1 + s²), where s is this variance divided by three times the output's
/// variance; for an output uniform in ±r that product is r². Cost: 7 multiply-adds, and 9 per output.
template <class Scalar>
class Extrapolation {
  public:
    static constexpr int cost = 7; ///< multiply-adds of the constructor

    /// `feature_variance`: φ'Pφ, ≥ 0, in units of the noise variance; the others as in
    /// `ExtrapolationConstants`.
    constexpr Extrapolation(Scalar feature_variance, Scalar inverse_far_variance,
                            Scalar parameter_variance_factor = 0) noexcept
        : factor_(parameter_variance_factor > 0 ? parameter_variance_factor : Scalar(1)),
          measured_(inverse_far_variance > 0 || parameter_variance_factor > 0) {
        const Scalar relative = feature_variance * inverse_far_variance;
        const Scalar t = relative < 1 ? relative : Scalar(1);
        const Scalar square = (t + t) * (t + t);
        const Scalar sixth = square * square * square;
        doubt_ = sixth * (1 / (1 + sixth));
        unknown_ = (t + t + t + t) / (1 + t + t + t);
    }

    /// Returns the fraction by which the features' part is reduced, in [0, 1).
    [[nodiscard]] constexpr Scalar doubt() const noexcept { return doubt_; }

    /// Returns the fraction of the output's prior variance that applies at this φ, in [0, 1].
    [[nodiscard]] constexpr Scalar unknown() const noexcept { return unknown_; }

    /// Returns the fraction by which the whole prediction is reduced, in [0, 1], because the physics'
    /// parameters are undetermined at this input. `ratio` and `feature_variance`: see variance().
    [[nodiscard]] constexpr Scalar parameter_doubt(Scalar ratio, Scalar feature_variance,
                                                   Scalar output_variance) const noexcept {
        const Scalar range_square = 3 * output_variance;
        const Scalar share =
            of_parameters(ratio, feature_variance) / (range_square > 0 ? range_square : unlimited);
        const Scalar s = share < largest_share ? share : largest_share;
        const Scalar square = s * s;
        const Scalar doubt = square / (1 + square);
        return output_variance > 0 ? doubt : Scalar(0);
    }

    /// Returns the variance of a measurement about the prediction. `ratio`: 1 + the variance of the predicted
    /// mean by P. `feature_variance`: the features' part of it; the rest belongs to the physics' parameters
    /// and counts at most as the output's own variance.
    [[nodiscard]] constexpr Scalar variance(Scalar ratio, Scalar feature_variance, Scalar extra_noise,
                                            Scalar prior_variance,
                                            Scalar output_variance = 0) const noexcept {
        const Scalar rest = of_parameters(ratio, feature_variance);
        const Scalar bounded = output_variance > 0 && !(rest < output_variance) ? output_variance : rest;
        const Scalar not_finite = ratio - ratio; // 0 if finite. NOLINT(misc-redundant-expression)
        const Scalar calibrated = 1 + extra_noise + bounded + prior_variance * unknown_ + not_finite;
        return measured_ ? calibrated : ratio;
    }

  private:
    static constexpr Scalar largest_share = Scalar(1e6); ///< bound of s, so that s² is finite
    static constexpr Scalar unlimited = Scalar(1e30);

    [[nodiscard]] constexpr Scalar of_parameters(Scalar ratio, Scalar feature_variance) const noexcept {
        const Scalar variance = factor_ * (ratio - (1 + feature_variance));
        return variance > 0 ? variance : Scalar(0);
    }

    Scalar doubt_ = 0;
    Scalar unknown_ = 0;
    Scalar factor_;
    bool measured_;
};

} // namespace dfdyn
