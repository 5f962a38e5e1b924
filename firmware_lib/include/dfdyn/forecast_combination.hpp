// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/budget.hpp"
#include "dfdyn/snapshot.hpp"
#include "dfdyn/storage.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dfdyn {

/// One prediction from those of several estimators ("members") of the same m outputs.
///
/// Each output weighs each member in inverse proportion to the square of its expected square error: of its
/// mean square error over about `memory` samples, plus a multiple of the variance of its parameters at this
/// input. After J. M. Bates and C. W. J. Granger, "The combination of forecasts" (1969), whose weights are in
/// inverse proportion to the mean square error itself.
///
/// Errors one step ahead are mostly tracking: they do not show what a member would do if it stopped learning.
/// So `learn` takes also what each member predicts with weights that it had 0.2 to 0.4 s ago (`HeldWeights`);
/// the mean of both squares counts. The variance decides where nothing is learned, on a motion that was not
/// seen before.
///
/// The powers and a memory of 0.8 s were chosen on the UR5 recordings No5 and No6. Weights are in [0, 1] and
/// sum to 1, so that the combination of finite predictions lies among them. An error counts for at most a
/// hundred times the best member's, so that an absurd one is forgotten within five memories; without
/// `noise_std` that begins once the memory is full.
///
///     for each member j: estimate[j] = estimator[j].tick(sample, budget);   // into tables, member by member
///     combination.weigh(deviations);                        // at this input; without: by past errors alone
///     combination.combine(predictions, prediction);
///     if the sample was not refused: combination.learn(predictions, ahead, sample.output.data());
///     else: combination.skip();
///
/// Cost: `cost()`; 3 c m + 5 scalars for c members. Never allocates.
template <class Scalar, int members, int m>
class ForecastCombination {
  public:
    /// Times that the variance of a member's parameters counts beside errors lately measured. It counts more
    /// than once because it assumes white noise: with residuals of autocorrelation ρ, n samples carry the
    /// information of n (1 - ρ) / (1 + ρ), and ρ = 0.82 gives the factor 10. Chosen on the UR5 recordings No5
    /// and No6.
    static constexpr Scalar variance_factor = 10;
    /// The same while no error has been measured lately, for deviations that count correlation and what is
    /// unknown away from the data (`Extrapolation`). These bound 95 % of the errors; what they add to the
    /// noise is about four times the mean square. Chosen on the UR5 recordings No5 and No6, where 0.15 to
    /// 0.35 do as well, and on the servo's 00, 02 and 03, where it makes little difference.
    static constexpr Scalar calibrated_variance_factor = Scalar(0.25);

    /// `memory`: samples, ≥ 1; a smaller one counts as 1. `noise_std`: deviation of each member's noise for
    /// each output, member by member, > 0, in the outputs' units; the errors to expect at the start. nullptr:
    /// not known; members count alike until they have been seen to predict. `unjudged_factor`: times that the
    /// variance of the members' parameters counts until errors have been measured, and some memories after
    /// the last; ≥ 0.
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

    /// Back to what is expected at the start.
    constexpr void restart() noexcept {
        const bool known = noise_square_[0] > 0;
        set_trust(known ? Scalar(0) : Scalar(1));
        samples_ = known ? std::min(first_samples, memory_) : Scalar(0);
        for (int i = 0; i < count(); ++i) {
            mean_square_[i] = known ? noise_square_[i] : least;
        }
        weigh();
    }

    /// Weighs the members by their past errors and their standard deviations at this input, member by member,
    /// in the outputs' units, parameters and noise together as in `Estimate`. One that is no number counts as
    /// infinite.
    constexpr void weigh(const Scalar* deviations) noexcept {
        copy_mean_squares(weights_.data());
        weigh(weights_.data(), deviations, weights_.data());
    }

    /// Likewise with other mean square errors, as `copy_mean_squares` gave them, into `weights`, which may be
    /// the same table.
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

    /// `from`: a value of each output from each member, member by member; `to`: m values. Takes predictions,
    /// and their standard deviations, as of members whose errors go together.
    constexpr void combine(const Scalar* from, Scalar* to) const noexcept {
        combine(weights_.data(), from, to);
    }

    /// Likewise with other weights.
    constexpr void combine(const Scalar* weights, const Scalar* from, Scalar* to) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            Scalar sum = 0;
            for (int j = 0; j < members_; ++j) {
                sum += weights[at(j, k)] * from[at(j, k)];
            }
            to[k] = sum;
        }
    }

    /// Learns how the members' predictions of a sample compare with its m outputs. `ahead`: what they predict
    /// for it with weights of a while ago; may be `predictions`. Then weighs by the errors alone.
    constexpr void learn(const Scalar* predictions, const Scalar* ahead, const Scalar* measured) noexcept {
        copy_mean_squares(mean_square_.data());
        set_trust(1);
        const bool scaled = samples_ >= memory_ || noise_square_[0] > 0; // it is known what is absurd
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

    /// A tick that learns nothing: past errors count for less, the members' noise for more, until after a
    /// memory the noise and the variances decide. The last errors before a standstill say little about a
    /// motion that follows. Without `noise_std` it does nothing.
    constexpr void skip() noexcept {
        set_trust(trust_ * (noise_square_[0] > 0 ? 1 - 1 / memory_ : Scalar(1)));
    }

    /// `learn` by the errors of the predictions alone.
    constexpr void learn(const Scalar* predictions, const Scalar* measured) noexcept {
        learn(predictions, predictions, measured);
    }

    /// Multiply-adds, at most. `predict`: of `weigh` (8 c m for c members) and two calls of `combine` (c m
    /// each), for predictions and deviations. `learn`: of `learn` or `skip`.
    [[nodiscard]] static constexpr Cost cost(Extent<members> member_count, Extent<m> output_count) noexcept {
        const std::int64_t table = std::int64_t{member_count} * output_count;
        return {.predict = 10 * table,
                .variance = 0,
                .learn = 11 * table,
                .forget = 0,
                .largest_step = 11 * table};
    }

    /// Of each member for each output, member by member.
    [[nodiscard]] constexpr const Scalar* weights() const noexcept { return weights_.data(); }
    /// Copies the mean square errors that count now, member by member.
    constexpr void copy_mean_squares(Scalar* to) const noexcept {
        for (int i = 0; i < count(); ++i) {
            to[i] = trust_ * mean_square_[i] + (1 - trust_) * noise_square_[i];
        }
    }

    [[nodiscard]] std::size_t snapshot_bytes() const noexcept { return dfdyn::snapshot_bytes(*this); }

    /// Writes what has been learned to the front of `buffer`, of at least `snapshot_bytes()`.
    [[nodiscard]] SnapshotResult snapshot(std::span<std::byte> buffer) const noexcept {
        return write_snapshot(*this, identity(), buffer);
    }

    /// Restores a snapshot of a combination of as many members and outputs, whole or not at all.
    [[nodiscard]] SnapshotResult restore(std::span<const std::byte> buffer) noexcept {
        const SnapshotResult result = read_snapshot(*this, identity(), buffer);
        set_trust(1);
        weigh();
        return result;
    }

    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        visitor.ranged(self.samples_, Scalar(0), self.memory_);
        for (auto& mean : self.mean_square_) {
            visitor.ranged(mean, least, largest);
        }
    }

  private:
    static constexpr int size = product(members, m);
    static constexpr Scalar least = Scalar(1e-30);  ///< mean square error: none is better than this …
    static constexpr Scalar largest = Scalar(1e30); ///< … nor worse than this
    static constexpr Scalar outlier = Scalar(1e4);  ///< times the best: no single square counts for more
    static constexpr Scalar first_samples = 10;     ///< that the noise counts for at the start
    using Table = Storage<Scalar, size>;

    [[nodiscard]] constexpr int count() const noexcept { return members_ * outputs_; }

    [[nodiscard]] constexpr int at(int member, int output) const noexcept {
        return member * outputs_ + output;
    }

    /// At most `most`, also of what is no number.
    [[nodiscard]] static constexpr Scalar square(Scalar error, Scalar most) noexcept {
        const Scalar value = error * error;
        return value < most ? std::max(value, least) : most;
    }

    /// The least mean square error of the output.
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

    /// By past errors alone.
    constexpr void weigh() noexcept {
        std::copy(mean_square_.begin(), mean_square_.end(), weights_.begin());
        for (int k = 0; k < outputs_; ++k) {
            normalise(k, weights_.data());
        }
    }

    /// From an output's expected square errors to its weights, in place.
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
    Scalar factor_ = variance_factor; ///< times that variance beyond the noise counts now
    Scalar samples_ = 0;              ///< that the means are over, at most the memory
    Scalar trust_ = 1;                ///< in the means, in [0, 1]; the rest is the noise's
    Table noise_square_;              ///< zero: not known
    Table mean_square_;
    Table weights_;
};

} // namespace dfdyn
