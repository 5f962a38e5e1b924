// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/storage.hpp"

namespace dfdyn {

/// What a model with features knows of the outputs away from its data; `dfdyn train` measures it. All zero,
/// also absent: predictions and standard deviations are the paper's.
template <class Scalar, int m>
struct ExtrapolationConstants {
    /// 1 / (trace(P) / 2d), P of the start: the inverse of φ'Pφ, in units of the noise's variance, at a φ
    /// that has nothing in common with the data.
    Scalar inverse_far_variance = 0;
    Storage<Scalar, m> extra_noise{};    ///< variance near the data beyond the noise's, in its units; ≥ 0
    Storage<Scalar, m> prior_variance{}; ///< of what features add, where nothing is known, in the same units
};

/// How much of a prediction by features to doubt at one φ.
///
/// The novelty t = φ'Pφ / (its value far from all data), at most 1, is near 0 where the data are and 1 where
/// no row learned resembles φ. There the features' part of the prediction is noise as large as the weights:
/// unlike a kernel, finitely many features never fade out. It is therefore weighted by 1 / (1 + (2t)^6),
/// which is 1 to single precision below t = 0.03, 0.996 at 0.2, and 0.015 at 1. The variance of its error is
/// the output's own prior variance times 4t / (1 + 3t): the odds of novelty count four times, because
/// residuals of real arms are correlated in time and teach less than as many independent ones. Shape and
/// constants were chosen on two motions of one measured arm and on a servo (see docs/extrapolation.md). 7
/// multiply-adds.
template <class Scalar>
class Extrapolation {
  public:
    static constexpr int cost = 7;

    constexpr Extrapolation(Scalar feature_variance, Scalar inverse_far_variance) noexcept
        : measured_(inverse_far_variance > 0) {
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

    /// The variance of a measurement about the prediction. `ratio`: 1 + that of the predicted mean by P,
    /// of which the features' part is `feature_variance`; the rest is that of the physics' parameters.
    [[nodiscard]] constexpr Scalar variance(Scalar ratio, Scalar feature_variance, Scalar extra_noise,
                                            Scalar prior_variance) const noexcept {
        const Scalar rest = ratio - (1 + feature_variance);
        const Scalar calibrated = 1 + extra_noise + (rest > 0 ? rest : Scalar(0)) + prior_variance * unknown_;
        return measured_ ? calibrated : ratio;
    }

  private:
    Scalar doubt_ = 0;
    Scalar unknown_ = 0;
    bool measured_;
};

} // namespace dfdyn
