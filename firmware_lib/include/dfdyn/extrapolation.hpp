// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/storage.hpp"

namespace dfdyn {

/// What a model knows of the outputs away from its data; `dfdyn train` measures it. All zero, also absent:
/// predictions and standard deviations are the paper's.
template <class Scalar, int m>
struct ExtrapolationConstants {
    /// 1 / (trace(P) / 2d), P of the start: the inverse of φ'Pφ, in units of the noise's variance, at a φ
    /// that has nothing in common with the data. 0 for a model without features.
    Scalar inverse_far_variance = 0;
    Storage<Scalar, m> extra_noise{};    ///< variance near the data beyond the noise's, in its units; ≥ 0
    Storage<Scalar, m> prior_variance{}; ///< of what features add, where nothing is known, in the same units
    /// Number of successive samples that teach the physics' parameters as much as one would with white noise:
    /// times that their variance counts. ≥ 1; 0: not measured, it counts once.
    Scalar parameter_variance_factor = 0;
    /// Of an output about its offset, where nothing is known, in units of the noise's variance; read with
    /// parameter_variance_factor.
    Storage<Scalar, m> output_variance{};

    [[nodiscard]] constexpr bool measured() const noexcept {
        return inverse_far_variance > 0 || parameter_variance_factor > 0;
    }
};

/// How much of a prediction by features to doubt at one φ.
///
/// The novelty t = φ'Pφ / (its value far from all data), at most 1, is near 0 where the data are and 1 where
/// no row learned resembles φ. There the features' part of the prediction is noise as large as the weights:
/// unlike a kernel, finitely many features never fade out. It is therefore weighted by 1 / (1 + (2t)^6),
/// which is 1 to single precision below t = 0.03, 0.996 at 0.2, and 0.015 at 1. The variance of its error is
/// the output's own prior variance times 4t / (1 + 3t): the odds of novelty count four times, because
/// residuals of real arms are correlated in time and teach less than as many independent ones. Shape and
/// constants were chosen on two motions of one measured arm and on a servo (see docs/extrapolation.md).
///
/// The variance of the physics' parameters counts `parameter_variance_factor` times, for the same reason.
/// Where the data have not determined what the physics says, it exceeds all that the output can do: a
/// prediction is weighted by 1 / (1 + s^2), s being this variance over that of the output times 3. For a
/// output uniform between ±r that is r². 7 multiply-adds, and 9 for each output.
template <class Scalar>
class Extrapolation {
  public:
    static constexpr int cost = 7;

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

    /// Share of the features' part that a prediction is better without, in [0, 1).
    [[nodiscard]] constexpr Scalar doubt() const noexcept { return doubt_; }

    /// Share of the output's own variance that is not known here, in [0, 1].
    [[nodiscard]] constexpr Scalar unknown() const noexcept { return unknown_; }

    /// Share of a whole prediction that it is better without, in [0, 1]: what the physics' parameters leave
    /// undetermined at this input. `ratio` and `feature_variance` as for variance().
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

    /// The variance of a measurement about the prediction. `ratio`: 1 + that of the predicted mean by P,
    /// of which the features' part is `feature_variance`; the rest is that of the physics' parameters, which
    /// counts at most for the output's own.
    [[nodiscard]] constexpr Scalar variance(Scalar ratio, Scalar feature_variance, Scalar extra_noise,
                                            Scalar prior_variance,
                                            Scalar output_variance = 0) const noexcept {
        const Scalar rest = of_parameters(ratio, feature_variance);
        const Scalar bounded = output_variance > 0 && !(rest < output_variance) ? output_variance : rest;
        const Scalar not_finite = ratio - ratio; // 0 otherwise. NOLINT(misc-redundant-expression)
        const Scalar calibrated = 1 + extra_noise + bounded + prior_variance * unknown_ + not_finite;
        return measured_ ? calibrated : ratio;
    }

  private:
    static constexpr Scalar largest_share = Scalar(1e6); ///< s is at most that, so that its square is finite
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
