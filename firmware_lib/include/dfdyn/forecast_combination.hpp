// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/snapshot.hpp"
#include "dfdyn/core/storage.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dfdyn {

/// Combines the predictions of several estimators ("members") of the same m outputs into one.
///
/// Per output, the weight of a member is inversely proportional to the square of its expected square error:
/// its mean square error over about `memory` samples, plus a multiple of the variance of its parameters at
/// this input. After J. M. Bates and C. W. J. Granger, "The combination of forecasts" (1969), where weights
/// are inversely proportional to the mean square error itself.
///
/// Errors one step ahead mostly measure tracking. They do not show how a member would predict if it stopped
/// learning. `learn` therefore also uses each member's prediction with its weights of 0.2 to 0.4 s ago
/// (`DelayedWeights`), and averages both squares. The variance decides where nothing is learned, on a motion
/// that was not seen before.
///
/// The powers and a memory of 0.8 s were chosen on the UR5 recordings No5 and No6. Weights are in [0, 1] and
/// sum to 1, so the combination of finite predictions lies between them. A square error is clipped to 10⁴
/// times the mean square error of the best member, so that an absurd error is forgotten within five memories;
/// without `noise_std` the clipping begins once the memory is full.
///
///     for each member j: estimate[j] = estimator[j].tick(sample, budget);   // into tables, member by member
///     combination.weigh(deviations);                        // at this input; without: by past errors alone
///     combination.combine(predictions, prediction);
///     if the sample was not refused: combination.learn(predictions, ahead, sample.output.data());
///     else: combination.skip();
///
/// Tables contain m values per member, member by member. Cost: `cost()`; 3 c m + 5 scalars for c members.
/// Never allocates.
template <class Scalar, int members, int m>
class ForecastCombination {
  public:
    /// Factor on the variance of a member's parameters while recent errors are available. It is greater than
    /// 1 because the variance assumes white noise: with residuals of autocorrelation ρ, n samples carry the
    /// information of n (1 - ρ) / (1 + ρ) samples, and ρ = 0.82 gives the factor 10. Chosen on the UR5
    /// recordings No5 and No6.
    static constexpr Scalar variance_factor = 10;
    /// Factor while no recent errors are available, for deviations that include correlation and the
    /// uncertainty away from the data (`Extrapolation`). Such deviations bound 95 % of the errors; their
    /// variance beyond the noise is about four times the mean square error. Chosen on the UR5 recordings No5
    /// and No6, where 0.15 to 0.35 perform equally, and on the servo's recordings 00, 02 and 03, where it
    /// makes little difference.
    static constexpr Scalar calibrated_variance_factor = Scalar(0.25);

    /// `memory`: samples, ≥ 1; smaller values count as 1. `noise_std`: standard deviation of each member's
    /// noise per output, a table of values > 0 in the outputs' units, used as the expected errors at the
    /// start; nullptr if unknown: members then have equal weights until their errors are known.
    /// `unjudged_factor`: factor on the variance of the members' parameters before the first error and some
    /// memories after the last; ≥ 0.
    constexpr ForecastCombination(Extent<members> member_count, Extent<m> output_count, Scalar memory,
                                  const Scalar* noise_std = nullptr,
                                  Scalar unjudged_factor = variance_factor) noexcept
        : members_(member_count), outputs_(output_count), memory_(memory > 1 ? memory : Scalar(1)),
          unjudged_factor_(unjudged_factor > 0 ? unjudged_factor : Scalar(0)),
          noise_square_(Table::zeros(extent<size>(member_count * output_count))), mean_square_(noise_square_),
          weights_(noise_square_) {
        for (int i = 0; i < count() && noise_std != nullptr; ++i) {
            noise_square_[i] = square(noise_std[i], largest);
        }
        restart();
    }

    /// Returns to the state after construction.
    constexpr void restart() noexcept {
        const bool known = noise_square_[0] > 0;
        set_trust(known ? Scalar(0) : Scalar(1));
        samples_ = known ? std::min(first_samples, memory_) : Scalar(0);
        for (int i = 0; i < count(); ++i) {
            mean_square_[i] = known ? noise_square_[i] : least;
        }
        weigh();
    }

    /// Computes the weights from past errors and from `deviations`, the members' standard deviations at this
    /// input: a table in the outputs' units, including parameters and noise as in `Estimate`. NaN counts as
    /// infinite.
    constexpr void weigh(const Scalar* deviations) noexcept {
        copy_mean_squares(weights_.data());
        weigh(weights_.data(), deviations, weights_.data());
    }

    /// Same, from the given mean square errors (see `copy_mean_squares`) into the table `weights`, which may
    /// be the table `mean_squares`.
    constexpr void weigh(const Scalar* mean_squares, const Scalar* deviations,
                         Scalar* weights) const noexcept {
        for (int i = 0; i < count(); ++i) {
            const Scalar variance = square(deviations[i], largest) - noise_square_[i];
            weights[i] =
                std::clamp(mean_squares[i] + factor_ * std::max(variance, Scalar(0)), least, largest);
        }
        for (int k = 0; k < outputs_; ++k) {
            normalise(k, weights);
        }
    }

    /// Combines the table `from` into the m values `to`. Use it for predictions, and for their standard
    /// deviations as if the members' errors were fully correlated.
    constexpr void combine(const Scalar* from, Scalar* to) const noexcept {
        combine(weights_.data(), from, to);
    }

    /// Same, with the given weights.
    constexpr void combine(const Scalar* weights, const Scalar* from, Scalar* to) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            Scalar sum = 0;
            for (int j = 0; j < members_; ++j) {
                sum += weights[at(j, k)] * from[at(j, k)];
            }
            to[k] = sum;
        }
    }

    /// Updates the mean square errors from the members' predictions of a sample and its m measured outputs.
    /// `ahead`: predictions of the same sample with older weights; may be `predictions`. Then computes the
    /// weights from the errors alone.
    constexpr void learn(const Scalar* predictions, const Scalar* ahead, const Scalar* measured) noexcept {
        copy_mean_squares(mean_square_.data());
        set_trust(1);
        // the scale of plausible errors is known
        const bool scaled = samples_ >= memory_ || noise_square_[0] > 0;
        samples_ = samples_ < memory_ ? samples_ + 1 : memory_;
        for (int k = 0; k < outputs_; ++k) {
            const Scalar most = scaled ? std::min(outlier * best_of(k), largest) : largest;
            for (int j = 0; j < members_; ++j) {
                Scalar& mean = mean_square_[at(j, k)];
                const Scalar now = (square(predictions[at(j, k)] - measured[k], most) +
                                    square(ahead[at(j, k)] - measured[k], most)) /
                                   2;
                mean = std::clamp(mean + (now - mean) / samples_, least, largest);
            }
        }
        weigh();
    }

    /// Accounts for a tick without learning: the influence of past errors decays, and after one memory the
    /// members' noise and variances decide. The last errors before a standstill carry little information
    /// about the next motion. Has no effect without `noise_std`.
    constexpr void skip() noexcept {
        set_trust(trust_ * (noise_square_[0] > 0 ? 1 - 1 / memory_ : Scalar(1)));
    }

    /// Same as `learn` with `ahead` equal to `predictions`.
    constexpr void learn(const Scalar* predictions, const Scalar* measured) noexcept {
        learn(predictions, predictions, measured);
    }

    /// Maximum multiply-adds. `predict`: one `weigh` (8 c m for c members) and two `combine` (c m each), for
    /// predictions and deviations. `learn`: one `learn` or `skip`.
    [[nodiscard]] static constexpr Cost cost(Extent<members> member_count, Extent<m> output_count) noexcept {
        const std::int64_t table = std::int64_t{member_count} * output_count;
        return {.predict = 10 * table,
                .variance = 0,
                .learn = 11 * table,
                .forget = 0,
                .largest_step = 11 * table};
    }

    /// Returns the weights, a table.
    [[nodiscard]] constexpr const Scalar* weights() const noexcept { return weights_.data(); }
    /// Copies the mean square errors in use into a table.
    constexpr void copy_mean_squares(Scalar* to) const noexcept {
        for (int i = 0; i < count(); ++i) {
            to[i] = trust_ * mean_square_[i] + (1 - trust_) * noise_square_[i];
        }
    }

    /// Returns the size of a snapshot, in bytes.
    [[nodiscard]] std::size_t snapshot_bytes() const noexcept { return dfdyn::snapshot_bytes(*this); }

    /// Writes the learned state to the front of `buffer`, which holds at least `snapshot_bytes()`.
    [[nodiscard]] SnapshotResult snapshot(std::span<std::byte> buffer) const noexcept {
        return write_snapshot(*this, identity(), buffer);
    }

    /// Restores a snapshot of a combination with the same numbers of members and outputs. A rejected snapshot
    /// changes nothing.
    [[nodiscard]] SnapshotResult restore(std::span<const std::byte> buffer) noexcept {
        const SnapshotResult result = read_snapshot(*this, identity(), buffer);
        set_trust(1);
        weigh();
        return result;
    }

    /// Visits the contents of a snapshot.
    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        visitor.ranged(self.samples_, Scalar(0), self.memory_);
        for (auto& mean : self.mean_square_) {
            visitor.ranged(mean, least, largest);
        }
    }

  private:
    static constexpr int size = product(members, m);
    static constexpr Scalar least = Scalar(1e-30);  ///< smallest mean square error
    static constexpr Scalar largest = Scalar(1e30); ///< largest mean square error
    static constexpr Scalar outlier = Scalar(1e4); ///< bound of a square error, relative to the best member's
    static constexpr Scalar first_samples = 10;    ///< weight of the noise at the start
    using Table = Storage<Scalar, size>;

    [[nodiscard]] constexpr int count() const noexcept { return members_ * outputs_; }

    [[nodiscard]] constexpr int at(int member, int output) const noexcept {
        return member * outputs_ + output;
    }

    /// Returns error² clipped to [`least`, `most`]; `most` if the error is NaN.
    [[nodiscard]] static constexpr Scalar square(Scalar error, Scalar most) noexcept {
        const Scalar value = error * error;
        return value < most ? std::max(value, least) : most;
    }

    /// Returns the smallest mean square error of an output.
    [[nodiscard]] constexpr Scalar best_of(int output) const noexcept {
        Scalar best = largest;
        for (int j = 0; j < members_; ++j) {
            best = std::min(best, mean_square_[at(j, output)]);
        }
        return best;
    }

    [[nodiscard]] std::uint32_t identity() const noexcept {
        return (static_cast<std::uint32_t>(members_) << 16U) + static_cast<std::uint32_t>(outputs_);
    }

    constexpr void set_trust(Scalar trust) noexcept {
        trust_ = trust;
        factor_ =
            trust < 1 ? unjudged_factor_ + trust * (variance_factor - unjudged_factor_) : variance_factor;
    }

    /// Computes the weights from past errors alone.
    constexpr void weigh() noexcept {
        std::copy(mean_square_.begin(), mean_square_.end(), weights_.begin());
        for (int k = 0; k < outputs_; ++k) {
            normalise(k, weights_.data());
        }
    }

    /// Converts an output's expected square errors to weights, in place.
    constexpr void normalise(int output, Scalar* weights) const noexcept {
        Scalar best = largest;
        for (int j = 0; j < members_; ++j) {
            best = std::min(best, weights[at(j, output)]);
        }
        Scalar sum = 0;
        for (int j = 0; j < members_; ++j) {
            const Scalar ratio = best / weights[at(j, output)];
            weights[at(j, output)] = ratio * ratio;
            sum += ratio * ratio;
        }
        for (int j = 0; j < members_; ++j) {
            weights[at(j, output)] /= sum;
        }
    }

    [[no_unique_address]] Extent<members> members_;
    [[no_unique_address]] Extent<m> outputs_;
    Scalar memory_;
    Scalar unjudged_factor_;
    Scalar factor_ = variance_factor; ///< present factor on the variance beyond the noise
    Scalar samples_ = 0;              ///< memory of the means so far, at most `memory_`
    Scalar trust_ = 1;                ///< share of the past errors, in [0, 1]; the rest is the noise's
    Table noise_square_;              ///< zero: unknown
    Table mean_square_;
    Table weights_;
};

} // namespace dfdyn
