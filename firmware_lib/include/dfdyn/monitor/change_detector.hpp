// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/storage.hpp"
#include "dfdyn/monitor/block_noise.hpp"
#include "dfdyn/monitor/false_alarm_threshold.hpp"
#include "dfdyn/monitor/output_block.hpp"
#include "dfdyn/monitor/standstill_range.hpp"

#include <cmath>
#include <cstdint>

namespace dfdyn {

/// Kinds of deviation of the innovations from their usual distribution.
enum class Departure : std::uint8_t { growth, shift, friction, payload, force, burst };
inline constexpr int departure_count = 6;

/// Detects changes in the block means of m normalised innovations.
///
/// Block means are whitened with the usual scale and autocorrelation at the speed of their joint
/// (`BlockNoise`). CUSUMs (E. S. Page, 1954) of log-likelihood ratios test Gaussian noise against
/// - growth, per output: twice the standard deviation;
/// - shift, per output and sign: a constant;
/// - friction, per joint and sign: a torque against the motion (joint torques only);
/// - payload, per sign: weight and inertia of a mass at the tool, over all outputs;
/// - force, per axis of the base and sign: a force at the tool, over all outputs.
/// Whitened innovations are clamped at three standard deviations. `shift_size` and `force_size` are the sizes
/// of the alternatives, in standard deviations of a block. One more sum is for short and large disturbances:
/// - burst: log(e²/2²) of each whitened innovation |e| > 2, over all outputs; minus 2 per block.
/// A block adds at most `burst_limit` to it, so no single block raises an alarm.
///
/// At standstill (lowest speed class, joint torques only) an innovation is evidence only beyond the range
/// that stiction has shown in earlier standstills (`StandstillRange`): the excess of its level, or a larger
/// change from block to block.
///
/// The threshold of each kind follows from its own excursions (`FalseAlarmThreshold`). All kinds together
/// exceed their thresholds at most once in `blocks_between_false_alarms` while the innovations are
/// stationary. The onset is the block in which the sum that raised the alarm last left zero. The alarm ends
/// when every sum is below half its threshold: the change was learned or has passed. `report_false_alarm`
/// reports a false alarm.
///
/// Cost per block: `cost(m)`. Memory: about 55 m numbers.
template <class Scalar, int m>
class ChangeDetector {
  public:
    using Block = OutputBlock<Scalar>;
    static constexpr int settling_blocks = 200; ///< without alarms after the start
    static constexpr Scalar shift_size = Scalar(1.5);
    static constexpr Scalar force_size = Scalar(1.5);
    static constexpr Scalar cut_off = 3;
    static constexpr Scalar burst_from = 2;
    static constexpr Scalar burst_drift = 2;
    static constexpr Scalar burst_limit = 12;
    /// Standard deviations of the error at standstill and of its change, as shares of their usual maxima.
    static constexpr Scalar level_scale = Scalar(1. / 3);
    static constexpr Scalar change_scale = Scalar(0.1);
    static constexpr Scalar least_range = Scalar(0.1); ///< smallest maximum, in predicted deviations
    /// Ratio of the specified rate of false alarms to the rate for which thresholds are computed: the tails
    /// of the sums of real arms are heavier than exponential (measured, docs/guide/monitor.md).
    static constexpr Scalar caution = 20;

    /// `friction`: true if outputs are joint torques. `blocks_between_false_alarms` > 1: mean number of
    /// blocks between them. `least_scale`: lower bound of the usual scale of block means, in predicted
    /// deviations.
    ChangeDetector(Extent<m> outputs, bool friction, Scalar blocks_between_false_alarms,
                   Scalar least_scale = Scalar(1e-6)) noexcept
        : outputs_(outputs), has_friction_(friction),
          blocks_between_(departure_count * caution * blocks_between_false_alarms),
          noise_(Storage<BlockNoise<Scalar>, m>::zeros(outputs)),
          range_(Storage<StandstillRange<Scalar>, m>::zeros(outputs)),
          sums_(Storage<Cusum, sums_of(m)>::zeros(extent<sums_of(m)>(sums_of(outputs)))) {
        std::fill(noise_.begin(), noise_.end(), BlockNoise<Scalar>(least_scale));
        set_limits();
    }

    /// Adds the next block and its predecessor (null after a gap), m values each. Returns true during an
    /// alarm. Cost: `cost`.
    bool add(const Block* now, const Block* before, const SpeedClasses<Scalar>& speed) noexcept {
        Shared shared;
        for (int k = 0; k < outputs_; ++k) {
            const int c = speed.of(now[k].speed);
            const int last = before == nullptr ? -1 : speed.of(before[k].speed);
            const Block& other = before == nullptr ? now[k] : before[k];
            if (has_friction_ && c == 0) {
                sum_standing(k, now[k], last == 0 ? before + k : nullptr, shared);
                continue;
            }
            range_[k].end();
            const Whitening<Scalar> whitening = noise_[k].whitening(c, last);
            if (whitening.now > 0) {
                const Scalar whole = whitening.of(now[k].innovation, other.innovation);
                sum_output(k, whole, whitening, now[k], other, shared);
            }
            if (!alarm_) {
                noise_[k].learn(now[k].innovation, other.innovation, c, last);
            }
        }
        sum_shared(shared);
        decide();
        return alarm_;
    }

    [[nodiscard]] bool alarm() const noexcept { return alarm_; }
    /// Returns the kind of the sum that raised the last alarm, and its output; m: all outputs together.
    [[nodiscard]] Departure departure() const noexcept { return kind_of(raised_); }
    [[nodiscard]] int channel() const noexcept { return output_of(raised_); }
    /// Returns the number of blocks since the onset of the present alarm, including the onset's block.
    [[nodiscard]] int blocks_since_onset() const noexcept { return since_onset_; }

    /// Resets the sums and the alarm. The learned noise and thresholds remain.
    void restart() noexcept {
        alarm_ = false;
        for (Cusum& sum : sums_) {
            sum = {};
        }
    }

    /// Accepts the present innovations as usual: learns noise and ranges again.
    void adopt() noexcept {
        for (BlockNoise<Scalar>& noise : noise_) {
            noise.relearn();
        }
        for (StandstillRange<Scalar>& range : range_) {
            range.relearn();
        }
        settled_ = 0;
        restart();
    }

    /// Reports that the last alarm was false: its excursion is added to the usual ones.
    void report_false_alarm() noexcept {
        FalseAlarmThreshold<Scalar>& tail = tails_[static_cast<int>(departure())];
        tail.add(limits_[static_cast<int>(departure())]);
    }

    /// Returns the maximum multiply-adds of `add`.
    static constexpr std::int64_t cost(int outputs) noexcept {
        const std::int64_t limits = std::int64_t{departure_count} * FalseAlarmThreshold<Scalar>::limit_cost;
        return limits + outputs * (BlockNoise<Scalar>::cost + function_cost + 66) +
               shared_columns * (function_cost + 8) + 2 * sums_of(outputs);
    }

    [[nodiscard]] const BlockNoise<Scalar>& noise(int output) const noexcept { return noise_[output]; }
    [[nodiscard]] Scalar limit(Departure kind) const noexcept { return limits_[static_cast<int>(kind)]; }

  private:
    static constexpr int shared_columns = 1 + force_columns; ///< payload's mass, force
    static constexpr Scalar power_memory = 600;              ///< blocks
    static constexpr Scalar power_first = 5;                 ///< blocks
    static constexpr Scalar power_outlier = 100;             ///< times the mean: upper bound of a block
    static constexpr Scalar largest_power = Scalar(1e12);    ///< upper bound of the first block

    struct Cusum {
        Scalar sum, peak;
        int blocks; ///< since the sum was zero
    };

    /// Sums Σ g e and Σ g² over all outputs, for each common column g.
    struct Shared {
        Scalar product[shared_columns] = {}, square[shared_columns] = {};
        Scalar burst = 0;
    };

    static constexpr int sums_of(int outputs) noexcept {
        return outputs == dynamic ? dynamic : 5 * outputs + 2 * shared_columns + 1;
    }
    [[nodiscard]] Departure kind_of(int index) const noexcept {
        if (index >= 5 * outputs_) {
            const int shared = index - 5 * outputs_;
            return shared < 2                    ? Departure::payload
                   : shared < 2 * shared_columns ? Departure::force
                                                 : Departure::burst;
        }
        return index < outputs_       ? Departure::growth
               : index < 3 * outputs_ ? Departure::shift
                                      : Departure::friction;
    }
    [[nodiscard]] int output_of(int index) const noexcept {
        return index < outputs_ ? index : index < 5 * outputs_ ? (index - outputs_) / 2 % outputs_ : outputs_;
    }

    /// Adds a block of a stationary joint; `before` is null if the joint moved in the block before.
    void sum_standing(int k, const Block& now, const Block* before, Shared& shared) noexcept {
        using std::abs;
        StandstillRange<Scalar>& range = range_[k];
        const Scalar level = now.innovation * now.deviation;
        const Scalar change = before == nullptr ? Scalar(0) : level - before->innovation * before->deviation;
        if (range.known()) {
            const Scalar least = least_range * now.deviation;
            const Scalar most_change = std::max(range.change(), least);
            const Scalar most = std::max(range.level(), least);
            const bool changed = abs(change) > most_change;
            const Scalar unit = changed ? change_scale * most_change : level_scale * most;
            const Scalar beyond = changed ? change : level - std::clamp(level, -most, most);
            const Scalar weight = now.deviation / unit;
            const Whitening<Scalar> whitening{weight,
                                              changed ? BlockNoise<Scalar>::most_alike * weight : Scalar(0)};
            sum_output(k, beyond / unit, whitening, now, changed ? *before : now, shared);
        }
        range.add(abs(level), abs(change), alarm_);
    }

    /// Adds a block with the whitened innovation `whole`.
    void sum_output(int k, Scalar whole, const Whitening<Scalar>& whitening, const Block& now,
                    const Block& before, Shared& shared) noexcept {
        const Scalar e = std::clamp(whole, -cut_off, cut_off);
        constexpr Scalar log_two = Scalar(0.693147);
        rise(k, Scalar(0.375) * e * e - log_two);
        if (whole * whole > burst_from * burst_from) {
            using std::log;
            shared.burst += log(std::min(whole * whole, Scalar(1e6)) / (burst_from * burst_from));
        }
        const Scalar size = shift_size * noise_[k].smallest();
        const Scalar shift = size * whitening.of(1, 1);
        both_signs(outputs_ + 2 * k, shift * e, shift * shift);
        if (has_friction_) {
            const Scalar friction = size * whitening.of(now.friction[0], before.friction[0]);
            both_signs(3 * outputs_ + 2 * k, friction * e, friction * friction);
        }
        const Whitening<Scalar> columns{whitening.now / now.deviation, whitening.before / before.deviation};
        for (int i = 0; i < shared_columns; ++i) {
            const Scalar column = i == 0 ? columns.of(now.payload[0], before.payload[0])
                                         : columns.of(now.force[i - 1], before.force[i - 1]);
            shared.product[i] += column * e;
            shared.square[i] += column * column;
        }
    }

    void sum_shared(const Shared& shared) noexcept {
        powers_ = std::min(powers_ + 1, power_memory);
        for (int i = 0; i < shared_columns; ++i) {
            learn_power(i, shared.square[i]);
            if (power_[i] > 0) {
                using std::sqrt;
                const Scalar size = (i == 0 ? shift_size : force_size) / sqrt(power_[i]);
                both_signs(5 * outputs_ + 2 * i, size * shared.product[i], size * size * shared.square[i]);
            }
        }
        rise(5 * outputs_ + 2 * shared_columns, std::min(shared.burst, burst_limit) - burst_drift);
    }

    /// Updates the mean power of a column. It starts with the smallest of the first few blocks. Later blocks
    /// are clamped at a multiple of the mean, so that absurd or non-finite columns do not hide later changes.
    void learn_power(int i, Scalar square) noexcept {
        Scalar& power = power_[i];
        const Scalar most = power > 0 ? power_outlier * power : largest_power;
        const Scalar bounded = std::min(most, square); // `most` if it is NaN
        if (powers_ <= power_first) {
            power = power > 0 ? std::min(power, bounded) : bounded;
        } else {
            power += (bounded - power) / powers_;
        }
    }

    /// Adds to the sums of a shift g δ and of -g δ: `product` is δ Σ g e, `square` is δ² Σ g².
    void both_signs(int index, Scalar product, Scalar square) noexcept {
        rise(index, product - square / 2);
        rise(index + 1, -product - square / 2);
    }

    void rise(int index, Scalar ratio) noexcept {
        Cusum& one = sums_[index];
        one.sum += ratio;
        if (one.sum > 0) {
            const Scalar limit = limits_[static_cast<int>(kind_of(index))];
            one.sum = alarm_ ? std::min(one.sum, limit) : one.sum;
            one.peak = std::max(one.peak, one.sum);
            ++one.blocks;
            return;
        }
        if (!alarm_ && 2 * settled_ >= settling_blocks) {
            tails_[static_cast<int>(kind_of(index))].add(one.peak);
        }
        one = {};
    }

    void decide() noexcept {
        if (settled_ < settling_blocks && ++settled_ == settling_blocks) {
            restart(); // the noise of the first sums was unknown
        }
        if (alarm_) {
            ++since_onset_;
            if (calm()) {
                restart();
            }
            return;
        }
        if (2 * settled_ >= settling_blocks) {
            for (FalseAlarmThreshold<Scalar>& tail : tails_) {
                tail.add_block();
            }
            set_limits();
        }
        if (settled_ == settling_blocks) {
            raise_alarm();
        }
    }

    void set_limits() noexcept {
        for (int kind = 0; kind < departure_count; ++kind) {
            limits_[kind] = tails_[kind].limit(blocks_between_);
        }
    }

    /// Raises the alarm of the sum with the largest ratio to its threshold, if one exceeds it.
    void raise_alarm() noexcept {
        Scalar farthest = 1;
        for (int index = 0; index < sums_.size(); ++index) {
            const Scalar share = sums_[index].sum / limits_[static_cast<int>(kind_of(index))];
            if (share > farthest) {
                farthest = share;
                alarm_ = true;
                raised_ = index;
                since_onset_ = sums_[index].blocks;
            }
        }
    }

    [[nodiscard]] bool calm() const noexcept {
        bool all = true;
        for (int index = 0; index < sums_.size(); ++index) {
            all = all && sums_[index].sum <= limits_[static_cast<int>(kind_of(index))] / 2;
        }
        return all;
    }

    [[no_unique_address]] Extent<m> outputs_;
    bool has_friction_;
    Scalar blocks_between_; ///< between two false alarms of one kind
    Storage<BlockNoise<Scalar>, m> noise_;
    Storage<StandstillRange<Scalar>, m> range_;
    Storage<Cusum, sums_of(m)> sums_;
    FalseAlarmThreshold<Scalar> tails_[departure_count];
    Scalar limits_[departure_count] = {};
    Scalar power_[shared_columns] = {}; ///< mean of Σ g²
    Scalar powers_ = 0;
    int settled_ = 0; ///< blocks since the start, at most `settling_blocks`
    int since_onset_ = 0;
    int raised_ = 0;
    bool alarm_ = false;
};

} // namespace dfdyn
