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

/// Combines the predictions of several estimators ("members") of the same m outputs into one.
///
/// Per output, the weight of a member is inversely proportional to the square of its expected square error at
/// this input. After J. M. Bates and C. W. J. Granger, "The combination of forecasts" (1969), where weights
/// are inversely proportional to the mean square error itself. The expected square error is
///  - while samples are learned: the mean square error one step ahead over about `memory` samples, times a
///    ratio of variances. The ratio is the variance of a measurement at this input divided by its mean over
///    the same samples, at least 1. Otherwise a member would gain from a period of uncertainty, for example
///    after a reset of its covariance;
///  - for predictions with older weights: the same with the errors of such predictions (`ahead`). Errors one
///    step ahead mostly measure tracking, and do not show how a member predicts without learning;
///  - before the first learned sample, and some memories after the last: the noise variance plus a factor
///    times the variance due to the parameters at this input. The influence of past errors decays gradually.
///
/// The power, the ratio of variances and a memory of 0.8 s were chosen on the UR5 recordings No5 and No6.
/// Weights are in [0, 1] and sum to 1, so the combination of finite predictions lies between them. A square
/// error is clipped to 10⁴ times the best member's mean square error. An absurd error is thus forgotten
/// within five memories. Without `noise_std` the clipping begins once the memory is full. A variance is
/// clipped to 10 times the member's mean.
///
///     for each member j: estimate[j] = estimator[j].tick(sample, budget);   // into tables, member by member
///     combination.weigh(deviations);                        // at this input; without: by past errors alone
///     combination.combine(predictions, prediction);
///     if the sample was not refused: combination.learn(predictions, ahead, sample.output.data());
///     else: combination.skip();
///
/// Tables contain m values per member, member by member. Cost: `cost()`; 6 c m + 6 scalars for c members.
/// Never allocates.
template <class Scalar, int members, int m>
class ForecastCombination {
  public:
    /// Factor on the variance of a member's parameters while no errors are known. It is greater than 1
    /// because the variance assumes white noise: with residuals of autocorrelation ρ, n samples carry the
    /// information of n (1 - ρ) / (1 + ρ) samples, and ρ = 0.82 gives the factor 10. Chosen on the UR5
    /// recordings No5 and No6.
    static constexpr Scalar variance_factor = 10;
    /// The same factor for deviations that include correlation and the uncertainty away from the data
    /// (`Extrapolation`). Such deviations bound 95 % of the errors; their variance beyond the noise is about
    /// four times the mean square error. Chosen on the UR5 recordings No5 and No6, where 0.15 to 0.35 perform
    /// equally, and on the servo's recordings 00, 02 and 03, where it makes little difference.
    static constexpr Scalar calibrated_variance_factor = Scalar(0.25);

    /// `memory`: samples, ≥ 1; smaller values count as 1. `noise_std`: standard deviation of each member's
    /// noise per output, a table of values > 0 in the outputs' units, used as the expected errors at the
    /// start; nullptr if unknown: members then have equal weights until their errors are known.
    /// `unjudged_factor`: factor on the variance of the members' parameters while no recent errors are known;
    /// ≥ 0.
    constexpr ForecastCombination(Extent<members> member_count, Extent<m> output_count, Scalar memory,
                                  const Scalar* noise_std = nullptr,
                                  Scalar unjudged_factor = variance_factor) noexcept
        : members_(member_count), outputs_(output_count), memory_(memory > 1 ? memory : Scalar(1)),
          unjudged_factor_(unjudged_factor > 0 ? unjudged_factor : Scalar(0)),
          noise_square_(Table::zeros(extent<size>(member_count * output_count))), mean_square_(noise_square_),
          mean_square_ahead_(noise_square_), variance_(noise_square_), mean_variance_(noise_square_),
          weights_(noise_square_) {
        for (int i = 0; i < count() && noise_std != nullptr; ++i) {
            noise_square_[i] = square(noise_std[i], largest);
        }
        restart();
    }

    /// Returns to the state after construction.
    constexpr void restart() noexcept {
        const bool known = noise_square_[0] > 0;
        trust_ = known ? Scalar(0) : Scalar(1);
        samples_ = known ? std::min(first_samples, memory_) : Scalar(0);
        skipped_ = 0;
        one_step_ = false;
        for (int i = 0; i < count(); ++i) {
            mean_square_[i] = mean_square_ahead_[i] = known ? noise_square_[i] : least;
            variance_[i] = mean_variance_[i] = mean_square_[i];
        }
        weigh();
    }

    /// Computes the weights from past errors and from `deviations`, the members' standard deviations at this
    /// input: a table in the outputs' units, including parameters and noise as in `Estimate`. NaN counts as
    /// infinite.
    constexpr void weigh(const Scalar* deviations) noexcept {
        for (int i = 0; i < count(); ++i) {
            variance_[i] = std::max(square(deviations[i], largest), noise_square_[i]);
        }
        weigh((one_step_ ? mean_square_ : mean_square_ahead_).data(), deviations, weights_.data());
    }

    /// Same, from the given mean square errors (see `copy_mean_squares`) into the table `weights`, which may
    /// be the table `mean_squares`.
    constexpr void weigh(const Scalar* mean_squares, const Scalar* deviations,
                         Scalar* weights) const noexcept {
        for (int i = 0; i < count(); ++i) {
            const Scalar variance = std::max(square(deviations[i], largest), noise_square_[i]);
            const Scalar ratio = std::clamp(variance / mean_variance_[i], least_ratio, largest);
            const Scalar judged = std::min(mean_squares[i] * ratio, largest); // finite, for `blended`
            const Scalar unjudged = noise_square_[i] + unjudged_factor_ * (variance - noise_square_[i]);
            weights[i] = std::clamp(blended(judged, unjudged), least, largest);
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

    /// Updates the mean square errors with the members' `predictions` of a sample (a table) and its m
    /// `measured` outputs. Updates the mean variances with the deviations of the last `weigh`. `ahead`: table
    /// of predictions of the same sample with older weights; may be `predictions`. A NaN prediction counts as
    /// the largest possible error. An output whose measured value is NaN or infinite is left out: its errors
    /// and variances stay. Then computes the weights from the errors alone.
    constexpr void learn(const Scalar* predictions, const Scalar* ahead, const Scalar* measured) noexcept {
        for (int i = 0; i < count() && trust_ < 1; ++i) { // the past errors have lost influence
            mean_square_[i] = blended(mean_square_[i], noise_square_[i]);
            mean_square_ahead_[i] = blended(mean_square_ahead_[i], noise_square_[i]);
        }
        trust_ = 1;
        skipped_ = 0;
        one_step_ = true;
        // the scale of plausible errors is known
        const bool scaled = samples_ >= memory_ || noise_square_[0] > 0;
        samples_ = samples_ < memory_ ? samples_ + 1 : memory_;
        for (int k = 0; k < outputs_; ++k) {
            if (!std::isfinite(measured[k])) {
                continue;
            }
            update(mean_square_, predictions, measured[k], k, scaled);
            update(mean_square_ahead_, ahead, measured[k], k, scaled);
            for (int j = 0; j < members_; ++j) {
                Scalar& mean = mean_variance_[at(j, k)];
                const Scalar now = std::min(variance_[at(j, k)], scaled ? variance_outlier * mean : largest);
                mean = std::clamp(mean + (now - mean) / samples_, least, largest);
            }
        }
        weigh();
    }

    /// Accounts for a tick without learning. It has no effect for an eighth of a memory (0.1 s at 0.8 s):
    /// single refused or lost samples do not change the weights. Afterwards errors ahead replace the errors
    /// one step ahead, because the members' parameters become older. The influence of past errors then decays
    /// with a time constant of one memory: the last errors before a standstill carry little information about
    /// the next motion. Without `noise_std` nothing decays.
    constexpr void skip() noexcept {
        skipped_ = std::min(skipped_ + 1, memory_);
        if (skipped_ > patience * memory_) {
            trust_ *= noise_square_[0] > 0 ? 1 - 1 / memory_ : Scalar(1);
            one_step_ = false;
        }
    }

    /// Same as `learn` with `ahead` equal to `predictions`.
    constexpr void learn(const Scalar* predictions, const Scalar* measured) noexcept {
        learn(predictions, predictions, measured);
    }

    /// Maximum multiply-adds. `predict`: one `weigh` (10 c m for c members) and two `combine` (c m each), for
    /// predictions and deviations. `learn`: one `learn` or `skip`.
    [[nodiscard]] static constexpr Cost cost(Extent<members> member_count, Extent<m> output_count) noexcept {
        const std::int64_t table = std::int64_t{member_count} * output_count;
        const std::int64_t learn = 12 * table + 2 * output_count;
        return {.predict = 12 * table, .variance = 0, .learn = learn, .forget = 0, .largest_step = learn};
    }

    /// Returns the weights, a table.
    [[nodiscard]] constexpr const Scalar* weights() const noexcept { return weights_.data(); }
    /// Copies the mean square errors of predictions ahead into a table.
    constexpr void copy_mean_squares(Scalar* to) const noexcept {
        std::copy(mean_square_ahead_.begin(), mean_square_ahead_.end(), to);
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
        if (result == SnapshotResult::ok) {
            samples_ = std::min(samples_, memory_);
            trust_ = 1;
            skipped_ = 0;
            one_step_ = true;
            variance_ = mean_variance_;
            weigh();
        }
        return result;
    }

    /// Visits the contents of a snapshot.
    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        visitor.ranged(self.samples_, Scalar(0), largest);
        for (auto* const table : {&self.mean_square_, &self.mean_square_ahead_, &self.mean_variance_}) {
            for (auto& mean : *table) {
                visitor.ranged(mean, least, largest);
            }
        }
    }

  private:
    static constexpr int size = product(members, m);
    static constexpr Scalar least = Scalar(1e-30);  ///< smallest mean square error
    static constexpr Scalar largest = Scalar(1e30); ///< largest mean square error
    static constexpr Scalar outlier = Scalar(1e4); ///< bound of a square error, relative to the best member's
    static constexpr Scalar variance_outlier = 10; ///< bound of a variance, relative to the member's mean
    static constexpr Scalar least_ratio = 1;       ///< a spike of a variance must not reduce later errors
    static constexpr Scalar patience = Scalar(0.125); ///< skipped samples without effect, in memories
    static constexpr Scalar first_samples = 10;       ///< weight of the noise at the start
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

    /// Returns the smallest of the values of an output.
    [[nodiscard]] constexpr Scalar least_of(const Table& table, int output) const noexcept {
        Scalar best = largest;
        for (int j = 0; j < members_; ++j) {
            best = std::min(best, table[at(j, output)]);
        }
        return best;
    }

    /// Updates one output's mean square errors from predictions of a measured value.
    constexpr void update(Table& mean_squares, const Scalar* predictions, Scalar measured, int output,
                          bool scaled) noexcept {
        const Scalar most = scaled ? std::min(outlier * least_of(mean_squares, output), largest) : largest;
        for (int j = 0; j < members_; ++j) {
            Scalar& mean = mean_squares[at(j, output)];
            const Scalar now = square(predictions[at(j, output)] - measured, most);
            mean = std::clamp(mean + (now - mean) / samples_, least, largest);
        }
    }

    /// Interpolates between two expected square errors by the share of past errors.
    [[nodiscard]] constexpr Scalar blended(Scalar judged, Scalar unjudged) const noexcept {
        return unjudged + trust_ * (judged - unjudged);
    }

    [[nodiscard]] std::uint32_t identity() const noexcept {
        return (static_cast<std::uint32_t>(members_) << 16U) + static_cast<std::uint32_t>(outputs_);
    }

    /// Computes the weights from past errors alone.
    constexpr void weigh() noexcept {
        const Table& errors = one_step_ ? mean_square_ : mean_square_ahead_;
        std::copy(errors.begin(), errors.end(), weights_.begin());
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
    Scalar samples_ = 0;    ///< memory of the means so far, at most `memory_`
    Scalar trust_ = 1;      ///< share of the past errors, in [0, 1]; the variances have the rest
    Scalar skipped_ = 0;    ///< samples since the last one that was learned, at most `memory_`
    bool one_step_ = false; ///< errors one step ahead are used, not those ahead
    Table noise_square_;    ///< zero: unknown
    Table mean_square_;     ///< of errors one step ahead
    Table mean_square_ahead_;
    Table variance_;      ///< of a measurement about each prediction, at the last `weigh`
    Table mean_variance_; ///< mean of `variance_` over the same samples as the errors
    Table weights_;
};

} // namespace dfdyn
