// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/snapshot.hpp"
#include "dfdyn/core/storage.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dfdyn {

/// Second-order autoregression of a zero-mean scalar series, in lattice form, learned online.
///
/// The reflection coefficients are those of J. P. Burg, "Maximum entropy spectral analysis" (1975), with
/// exponential memory: 2 E[f b] / E[f² + b²], where f and b are the forward and backward errors of a stage.
/// Their magnitude is below 1 for any data, so the autoregression is stable. Values beyond `outlier` times
/// the root mean square are clipped to that bound.
template <class Scalar>
class LatticePredictor {
  public:
    static constexpr Scalar outlier = 10;               ///< root mean squares beyond which a value is clipped
    static constexpr int cost = 2 * function_cost + 26; ///< multiply-adds of `add` plus `next`, maximum

    /// Sets both stages to zero coefficients. `scale`: expected root mean square, > 0, in the series' unit.
    constexpr void reset(Scalar scale) noexcept {
        const Scalar square = std::clamp(scale * scale, least, largest);
        cross_[0] = cross_[1] = 0;
        power_[0] = power_[1] = square;
        restart();
    }

    /// Forgets the last values, so that the next value is the first of a new segment. Keeps the coefficients.
    constexpr void restart() noexcept { last_ = backward_ = 0; }

    /// Returns the forecast of the next value; 0 after a restart.
    [[nodiscard]] constexpr Scalar next() const noexcept {
        return reflection(0) * last_ + reflection(1) * backward_;
    }

    /// Appends a finite value. `seen`: number of values since the restart, ≥ 0; `samples`: memory of the
    /// means, ≥ 1.
    constexpr void add(Scalar value, int seen, Scalar samples) noexcept {
        const Scalar x = limited(value, power_[0]);
        Scalar backward = 0;
        if (seen >= 1) {
            update(0, x, last_, samples);
            backward = last_ - reflection(0) * x;
        }
        if (seen >= 2) {
            update(1, x - reflection(0) * last_, backward_, samples);
        }
        backward_ = backward;
        last_ = x;
    }

    /// Returns the autocorrelation at a lag of one sample, in (-1, 1).
    [[nodiscard]] constexpr Scalar correlation() const noexcept { return reflection(0); }

    /// Returns `value` clipped to ± `outlier` times the square root of `mean_square`.
    [[nodiscard]] static constexpr Scalar limited(Scalar value, Scalar mean_square) noexcept {
        using std::sqrt;
        const Scalar bound = outlier * sqrt(mean_square);
        return std::clamp(value, -bound, bound);
    }

    /// Visits the contents of a snapshot.
    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        for (int stage = 0; stage < 2; ++stage) {
            visitor.ranged(self.cross_[stage], -largest, largest);
            visitor.ranged(self.power_[stage], least, largest);
        }
    }

    static constexpr Scalar least = Scalar(1e-30);  ///< smallest mean square
    static constexpr Scalar largest = Scalar(1e30); ///< largest mean square

  private:
    static constexpr Scalar closest = Scalar(0.999); ///< largest magnitude of a coefficient

    [[nodiscard]] constexpr Scalar reflection(int stage) const noexcept {
        return std::clamp(cross_[stage] / power_[stage], -closest, closest);
    }

    constexpr void update(int stage, Scalar forward, Scalar backward, Scalar samples) noexcept {
        const Scalar power = (forward * forward + backward * backward) / 2;
        power_[stage] = std::clamp(power_[stage] + (power - power_[stage]) / samples, least, largest);
        cross_[stage] =
            std::clamp(cross_[stage] + (forward * backward - cross_[stage]) / samples, -largest, largest);
    }

    Scalar last_, backward_;     ///< last value, and its backward error of the first stage
    Scalar cross_[2], power_[2]; ///< means of f b and of (f² + b²) / 2, per stage
};

/// One-step forecast of m measured outputs from a model's prediction and the past measurements, for fault
/// detection and display.
///
/// **Never feed a forecast forward.** It follows the measured outputs, including the force of an external
/// contact. As feed-forward it would be positive feedback. Feed forward a prediction for the reference
/// instead: `FeedForward`.
///
/// The errors of a model are autocorrelated: at 125 Hz, and more so at 1 kHz, most of an error repeats the
/// previous one. The last output y(t-1) alone can therefore have a smaller error than the model. Each output
/// has two forecasts and a weight w:
///  - a: the model's prediction plus a second-order autoregression of its own residual;
///  - b: the last measurement plus a second-order autoregression of its differences;
///  - forecast: b + w (a - b), with w in [0, 1] the least-squares weight over the memory (C. W. J. Granger
///    and R. Ramanathan, "Improved methods of combining forecasts", 1984).
///
///      estimate = estimator.tick(sample, budget);
///      const Scalar* prediction = estimate.status.estimated() ? estimate.prediction.data() : nullptr;
///      if (prediction) residual.forecast(prediction, one_step); // of the measurement of this tick
///      if (sample.output_valid) residual.learn(prediction, sample.output.data());
///      else residual.restart();
///
/// A finite measurement may be learned here even if the estimator refused its sample, as during a contact:
/// every value is clipped to ten times the root mean square. Cost: `cost()`; 15 m scalars. Never allocates.
template <class Scalar, int m>
class ColouredResidual {
  public:
    /// `memory`: samples, ≥ 1 (smaller values count as 1). `noise_std`: standard deviations of the model's
    /// noise, m values > 0, in the outputs' units; they only set the initial scale.
    constexpr ColouredResidual(Extent<m> output_count, Scalar memory, const Scalar* noise_std) noexcept
        : outputs_(output_count), memory_(memory > 1 ? memory : 1), lines_(Lines::zeros(output_count)) {
        for (int k = 0; k < outputs_; ++k) {
            lines_[k].residual.reset(noise_std[k]);
            lines_[k].difference.reset(noise_std[k]);
            lines_[k].gap_square = std::clamp(noise_std[k] * noise_std[k], least, largest);
            lines_[k].agreement = lines_[k].gap_square / 2;
        }
    }

    /// Forgets the last samples and keeps the coefficients. Call it after a gap or without a usable
    /// measurement.
    constexpr void restart() noexcept {
        measurements_ = 0;
        for (Line& line : lines_) {
            line.difference.restart();
        }
        restart_residuals();
    }

    /// Forecasts the measurement of this tick; call it before `learn`. Writes m values into `one_step`, in
    /// the outputs' units. Without a measurement since the last restart the forecast is the prediction.
    /// `prediction`: m finite values.
    constexpr void forecast(const Scalar* prediction, Scalar* one_step) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            one_step[k] = measurements_ == 0 ? prediction[k] : parts_of(lines_[k], prediction[k]).forecast;
        }
    }

    /// Learns from the m measured outputs of this tick. `prediction`: m finite values, or nullptr without a
    /// prediction. Restarts instead if a measurement or an error is not finite or exceeds 1e15.
    constexpr void learn(const Scalar* prediction, const Scalar* measured) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            if (!usable(measured[k]) || (prediction != nullptr && !usable(measured[k] - prediction[k]))) {
                restart();
                return;
            }
        }
        if (prediction == nullptr) {
            restart_residuals();
        } else {
            samples_ = std::min(samples_ + 1, memory_);
        }
        for (int k = 0; k < outputs_; ++k) {
            if (prediction != nullptr) {
                learn_residual(lines_[k], prediction[k], measured[k]);
            }
            if (measurements_ > 0) {
                lines_[k].difference.add(measured[k] - lines_[k].last, measurements_ - 1, samples_);
            }
            lines_[k].last = measured[k];
        }
        measurements_ = std::min(measurements_ + 1, 3);
        residuals_ = prediction == nullptr ? 0 : std::min(residuals_ + 1, 2);
    }

    /// Returns the autocorrelation of a residual at a lag of one sample, in (-1, 1). 0 ≤ output < m.
    [[nodiscard]] constexpr Scalar correlation(int output) const noexcept {
        return lines_[output].residual.correlation();
    }

    /// Returns the maximum multiply-adds of a tick that forecasts and learns.
    [[nodiscard]] static constexpr std::int64_t cost(Extent<m> output_count) noexcept {
        return std::int64_t{output_count} * (2 * LatticePredictor<Scalar>::cost + 2 * function_cost + 24);
    }

    /// Returns the size of a snapshot, in bytes.
    [[nodiscard]] std::size_t snapshot_bytes() const noexcept { return dfdyn::snapshot_bytes(*this); }

    /// Writes the coefficients to the front of `buffer`, which holds at least `snapshot_bytes()`.
    [[nodiscard]] SnapshotResult snapshot(std::span<std::byte> buffer) const noexcept {
        return write_snapshot(*this, identity(), buffer);
    }

    /// Restores the coefficients of an object with the same number of outputs, of any memory, and restarts. A
    /// rejected snapshot changes nothing.
    [[nodiscard]] SnapshotResult restore(std::span<const std::byte> buffer) noexcept {
        const SnapshotResult result = read_snapshot(*this, identity(), buffer);
        if (result == SnapshotResult::ok) {
            samples_ = std::min(samples_, memory_);
            restart();
        }
        return result;
    }

    /// Visits the contents of a snapshot.
    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        visitor.ranged(self.samples_, Scalar(1), largest);
        for (auto& line : self.lines_) {
            LatticePredictor<Scalar>::visit_state(line.residual, visitor);
            LatticePredictor<Scalar>::visit_state(line.difference, visitor);
            visitor.ranged(line.agreement, -largest, largest);
            visitor.ranged(line.gap_square, least, largest);
        }
    }

  private:
    static constexpr Scalar least = LatticePredictor<Scalar>::least;
    static constexpr Scalar largest = LatticePredictor<Scalar>::largest;
    static constexpr Scalar beyond = Scalar(1e15);

    struct Line {
        LatticePredictor<Scalar> residual, difference;
        Scalar last;                  ///< last measurement
        Scalar agreement, gap_square; ///< means of (y - b)(a - b) and (a - b)²; their ratio is w
    };
    using Lines = Storage<Line, m>;

    struct Parts {
        Scalar by_output; ///< b
        Scalar gap;       ///< a - b, clipped
        Scalar forecast;
    };

    [[nodiscard]] static constexpr bool usable(Scalar value) noexcept {
        return value < beyond && value > -beyond;
    }

    constexpr void restart_residuals() noexcept {
        residuals_ = 0;
        for (Line& line : lines_) {
            line.residual.restart();
        }
    }

    [[nodiscard]] constexpr Parts parts_of(const Line& line, Scalar prediction) const noexcept {
        const Scalar b = line.last + line.difference.next();
        const Scalar gap =
            LatticePredictor<Scalar>::limited(prediction + line.residual.next() - b, line.gap_square);
        const Scalar weight = std::clamp(line.agreement / line.gap_square, Scalar(0), Scalar(1));
        return {b, gap, b + weight * gap};
    }

    constexpr void learn_residual(Line& line, Scalar prediction, Scalar measured) noexcept {
        if (measurements_ > 0) {
            const auto [b, gap, forecast] = parts_of(line, prediction);
            // Clipped like the gap: a larger error carries no more information about the weight.
            const Scalar error = LatticePredictor<Scalar>::limited(measured - b, line.gap_square);
            line.gap_square =
                std::clamp(line.gap_square + (gap * gap - line.gap_square) / samples_, least, largest);
            line.agreement =
                std::clamp(line.agreement + (error * gap - line.agreement) / samples_, -largest, largest);
        }
        line.residual.add(measured - prediction, residuals_, samples_);
    }

    [[nodiscard]] std::uint32_t identity() const noexcept {
        return 0x10000000U + static_cast<std::uint32_t>(outputs_);
    }

    [[no_unique_address]] Extent<m> outputs_;
    Scalar memory_;
    Scalar samples_ = first_samples; ///< memory of the means so far, at most `memory_`
    int measurements_ = 0;           ///< consecutive, at most 3
    int residuals_ = 0;              ///< consecutive, at most 2
    Lines lines_;

    static constexpr Scalar first_samples = 2; ///< weight of the initial scale
};

} // namespace dfdyn
