// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/estimate.hpp"
#include "dfdyn/extrapolation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn {

/// The outputs of one tick in the regression's units, relative to the offset and the noise standard deviation
/// that `Model::Constants` contain: the measurements, and the variance of each about its prediction. Every
/// function costs O(outputs).
template <class Model>
class ScaledOutputs {
  public:
    using Scalar = typename Model::Scalar;                    ///< float or double
    using Constants = typename Model::Constants;              ///< offsets, noise, limits, extrapolation
    using Sample = typename Model::Sample;                    ///< the measured outputs
    using Outputs = Storage<Scalar, Model::outputs>;          ///< one number per output
    using Estimate = dfdyn::Estimate<Scalar, Model::outputs>; ///< the prediction

    /// Multiply-adds per output for the conversion between the regression's units and the output's.
    static constexpr int conversion_cost = function_cost + 15;
    /// Multiply-adds per output in `innovation_square`.
    static constexpr int square_cost = 2;

    /// Starts with zeros.
    explicit ScaledOutputs(Extent<Model::outputs> outputs) noexcept
        : target_(Outputs::zeros(outputs)), ratio_(target_), without_features_(target_) {}

    /// Returns the measured outputs of the last `normalise`.
    [[nodiscard]] const Outputs& target() const noexcept { return target_; }
    /// Returns the buffer, one number per output, into which the regression writes ratios of variances.
    [[nodiscard]] Scalar* ratio() noexcept { return ratio_.data(); }
    /// Returns the buffer, one number per output, for the prediction of the physics alone.
    [[nodiscard]] Scalar* without_features() noexcept { return without_features_.data(); }

    /// Returns `ok` if the outputs are measured, finite and within their limits; otherwise the reason.
    [[nodiscard]] Reason check_measured(const Constants& constants, const Sample& sample) const noexcept {
        if (!sample.output_valid) {
            return Reason::output_missing;
        }
        for (int k = 0; k < target_.size(); ++k) {
            if (!std::isfinite(sample.output[k])) {
                return Reason::output_not_finite;
            }
            if (!(std::abs(sample.output[k]) <= constants.output_limit[k])) { // also for a NaN limit
                return Reason::output_out_of_range;
            }
        }
        return Reason::ok;
    }

    /// Converts the measured outputs to the regression's units (relative to offset and noise). Returns the
    /// sum of the squared differences from the prediction.
    Scalar normalise(const Constants& constants, const Sample& sample, const Outputs& prediction) noexcept {
        Scalar error_square = 0;
        for (int k = 0; k < target_.size(); ++k) {
            target_[k] = (sample.output[k] - constants.output_offset[k]) / constants.output_noise_std[k];
            const Scalar error = target_[k] - prediction[k];
            error_square += error * error;
        }
        return error_square;
    }

    /// Reduces the prediction, in units of the noise, by the doubt at its input (see `Extrapolation`).
    /// Converts the ratios to the variances of measurements about it. `reduce` false: does not reduce the
    /// prediction. After a change of the arm, P covers only the samples since then, but the weights are still
    /// the best estimate elsewhere.
    void extrapolate(const Constants& constants, Scalar feature_variance, bool reduce,
                     Estimate& estimate) noexcept {
        const auto& known = constants.extrapolation;
        const Extrapolation<Scalar> beyond(feature_variance, known.inverse_far_variance,
                                           known.parameter_variance_factor);
        const bool given = known.measured();
        const Scalar doubt = reduce ? beyond.doubt() : Scalar(0);
        for (int k = 0; k < target_.size(); ++k) {
            const Scalar output_variance = given ? known.output_variance[k] : Scalar(0);
            const Scalar open = beyond.parameter_doubt(ratio_[k], feature_variance, output_variance);
            const Scalar trust = 1 - (reduce ? open : Scalar(0));
            estimate.prediction[k] -= doubt * (estimate.prediction[k] - without_features_[k]);
            estimate.prediction[k] *= trust;
            ratio_[k] = beyond.variance(ratio_[k], feature_variance, given ? known.extra_noise[k] : Scalar(0),
                                        given ? known.prior_variance[k] : Scalar(0), output_variance);
        }
    }

    /// Returns the normalised squared innovation of the targets about a prediction in units of the noise,
    /// after `extrapolate`. Ignores the correlation of errors between outputs that share parameters.
    [[nodiscard]] Scalar innovation_square(const Outputs& prediction) const noexcept {
        Scalar total = 0;
        for (int k = 0; k < target_.size(); ++k) {
            const Scalar innovation = target_[k] - prediction[k];
            total += innovation * innovation / ratio_[k];
        }
        return std::min(total, std::numeric_limits<Scalar>::max());
    }

    /// Converts the estimate from the regression's units to the output's and applies the prediction limits.
    void to_output_units(const Constants& constants, const Sample& sample, bool measured,
                         Estimate& estimate) const noexcept {
        for (int k = 0; k < target_.size(); ++k) {
            const Scalar noise = constants.output_noise_std[k];
            estimate.prediction[k] = constants.output_offset[k] + noise * estimate.prediction[k];
            using std::sqrt;
            estimate.standard_deviation[k] = noise * sqrt(ratio_[k]);
            if (k < constants.prediction_limit.size()) { // may be absent with run-time sizes
                bound(constants.prediction_limit[k], k, estimate);
            }
            estimate.innovation[k] = measured ? sample.output[k] - estimate.prediction[k] : Scalar(0);
        }
    }

  private:
    /// Limits the prediction of output k to ±`limit` if `limit` > 0.
    static void bound(Scalar limit, int k, Estimate& estimate) noexcept {
        const Scalar own = estimate.prediction[k];
        if (!(limit > 0) || (own <= limit && own >= -limit)) {
            return;
        }
        const Scalar bounded = own > 0 ? limit : -limit;
        estimate.prediction[k] = bounded;
        const Scalar moved = own > 0 ? own - limit : -limit - own;
        Scalar& deviation = estimate.standard_deviation[k];
        deviation = std::max(deviation, moved);
        estimate.status.prediction = Reason::prediction_bounded;
    }

    Outputs target_;
    Outputs ratio_; ///< variance of a measurement about each prediction, in units of the noise variance
    Outputs without_features_; ///< prediction of the physics alone
};

} // namespace dfdyn
