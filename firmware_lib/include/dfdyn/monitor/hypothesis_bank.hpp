// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/cause.hpp"
#include "dfdyn/monitor/cause_fits.hpp"

namespace dfdyn {

/// Computes posterior probabilities of the causes of a change from their evidence (`CauseFits`) on the
/// residuals since its onset: fault isolation by Bayesian model comparison.
///
/// A bias, a friction or a push at a joint may affect some outputs only. Each output therefore uses the
/// better of the hypotheses "with" and "without", with log(2 m) subtracted from "with". The log-evidence is
/// multiplied by `trust`, because real residuals are neither Gaussian nor white, and columns are inexact.
template <class Scalar, int m>
class HypothesisBank {
  public:
    using Block = OutputBlock<Scalar>;
    using Speed = SpeedClasses<Scalar>;
    static constexpr Scalar trust = Scalar(0.2);
    static constexpr Scalar far = Scalar(3.5); ///< standard deviations of an unusual residual
    /// Log odds against a contact that persists, and against any other cause that was large and has passed.
    static constexpr Scalar duration_penalty = 6;
    static constexpr Scalar large = 8;                   ///< mean square of residuals, relative to the noise
    static constexpr Scalar payload_reach = Scalar(0.5); ///< m: largest distance of a payload from the tip
    static constexpr Scalar payload_deviations = 2;      ///< least distance of its mass from zero

    /// `friction`: true if each output is the torque of its own joint.
    HypothesisBank(Extent<m> outputs, bool friction) noexcept
        : outputs_(outputs), has_friction_(friction), fits_(outputs),
          recent_(Storage<Scalar, m>::zeros(outputs)), mean_push_(recent_) {}

    /// Adds a block without a change and its predecessor (null after a gap) to the noise estimates.
    void learn(const Block* now, const Block* before, const Speed& speed) noexcept {
        fits_.learn(now, before, speed);
    }
    void relearn() noexcept { fits_.relearn(); }

    /// Returns true if a whitened residual exceeds `far` standard deviations.
    [[nodiscard]] bool unusual(const Block* now, const Block* before, const Speed& speed) const noexcept {
        return fits_.largest(now, before, speed) > far;
    }

    /// Starts the fits. `block_at(b)`, 0 ≤ b < `count`: the stored blocks.
    template <class BlockAt>
    void start(const BlockAt& block_at, int count) noexcept {
        fits_.start(block_at, count);
        for (int k = 0; k < outputs_; ++k) {
            recent_[k] = mean_push_[k] = 0;
        }
        std::fill_n(mean_force_, force_columns, Scalar(0));
        energy_ = peak_power_ = 0;
    }

    /// Adds a block since the onset and its predecessor, m values each. Cost: `cost_of_add`.
    void add(const Block* now, const Block* before, const Speed& speed) noexcept {
        fits_.add(now, before, speed);
        Scalar energy = 0;
        for (int k = 0; k < outputs_; ++k) {
            const Scalar share = now[k].residual / fits_.noise(k).scale(speed.of(now[k].speed));
            recent_[k] += (std::min(share * share, Scalar(16)) - recent_[k]) / 5;
            energy += share * share;
            peak_power_ = std::max(peak_power_, recent_[k]);
        }
        note_push(energy);
    }

    /// Writes cause, runner-up, confidence and size into `change`. `frozen`: log odds of a repeated reading,
    /// 0 if there is none; `channel`: its channel.
    void judge(Scalar frozen, int channel, Change<Scalar, m>& change) const noexcept {
        Scalar logs[cause_count];
        weigh(logs);
        Scalar best = *std::max_element(logs, logs + cause_count);
        logs[static_cast<int>(Cause::frozen)] = frozen > 0 ? best + frozen : best - impossible;
        best = std::max(best, logs[static_cast<int>(Cause::frozen)]);
        Scalar total = 0;
        for (Scalar& log : logs) {
            using std::exp;
            log = exp(log - best);
            total += log;
        }
        rank(logs, total, change);
        describe(channel, change);
    }

    /// Maximum multiply-adds of `add`, `start` and `judge`.
    static constexpr std::int64_t cost_of_add(int outputs) noexcept {
        return CauseFits<Scalar, m>::cost(outputs) + outputs * (function_cost + 4) + 10;
    }
    static constexpr std::int64_t cost_of_start(int outputs, int count) noexcept {
        return CauseFits<Scalar, m>::cost_of_start(outputs, count);
    }
    static constexpr std::int64_t cost_of_judge(int outputs) noexcept {
        constexpr int evidences = 20; // evaluations per output, some of them repeated
        constexpr int payload =
            payload_columns * (HypothesisFit<Scalar, payload_columns, m, false>::deviation_cost + 4);
        return outputs * evidences * (function_cost + 6) + cause_count * (function_cost + 2) + payload + 10;
    }

  private:
    static constexpr Scalar impossible = 50;

    /// Updates the mean force and torque of a push, with the squared residuals as weights.
    void note_push(Scalar energy) noexcept {
        energy_ += energy;
        const Scalar share = energy_ > 0 ? energy / energy_ : Scalar(0);
        for (int i = 0; i < force_columns; ++i) {
            mean_force_[i] += share * (fits_.force.parameters()[i] * fits_.force_scale[i] - mean_force_[i]);
        }
        for (int k = 0; k < outputs_; ++k) {
            mean_push_[k] += share * (*fits_.push[k].parameters() * fits_.unit(k) - mean_push_[k]);
        }
    }

    /// Returns the log-evidence of output k with its own parameters, relative to none.
    template <class Fits>
    [[nodiscard]] Scalar gain(const Fits& fits, int k) const noexcept {
        using std::log;
        return fits[k].evidence().of(0) - fits_.nothing.of(k) - log(static_cast<Scalar>(2 * int{outputs_}));
    }

    /// Returns the output with the largest gain.
    template <class Fits>
    [[nodiscard]] int best_output(const Fits& fits) const noexcept {
        int best = 0;
        for (int k = 1; k < outputs_; ++k) {
            best = gain(fits, k) > gain(fits, best) ? k : best;
        }
        return best;
    }

    /// Returns the sum of the positive gains, or the largest gain if none is positive.
    template <class Fits>
    [[nodiscard]] Scalar gain_of_some(const Fits& fits) const noexcept {
        Scalar total = 0;
        Scalar best = gain(fits, 0);
        for (int k = 0; k < outputs_; ++k) {
            const Scalar one = gain(fits, k);
            best = std::max(best, one);
            total += std::max(one, Scalar(0));
        }
        return total + std::min(best, Scalar(0));
    }

    /// Returns true if the recent residuals are at the usual noise level.
    [[nodiscard]] bool ended() const noexcept {
        bool all = true;
        for (int k = 0; k < outputs_; ++k) {
            all = all && recent_[k] < 4;
        }
        return all;
    }

    /// Returns whether the fitted payload is physically possible. Its mass (negative: taken off) must differ
    /// from zero, and its centre must be within `payload_reach` of the tip along each axis. The tolerance is
    /// `payload_deviations` standard deviations of the fit.
    [[nodiscard]] bool payload_possible() const noexcept {
        using std::abs;
        const auto size = [&](int i) { return abs(fits_.payload.parameters()[i] * fits_.payload_scale[i]); };
        const auto uncertain = [&](int i) {
            return payload_deviations * fits_.payload.deviation(i) * fits_.payload_scale[i];
        };
        bool possible = size(0) > uncertain(0);
        for (int i = 1; i < payload_columns; ++i) {
            possible = possible && size(i) - uncertain(i) <= payload_reach * size(0);
        }
        return possible;
    }

    void weigh(Scalar* logs) const noexcept {
        const auto set = [logs](Cause cause, Scalar value) { logs[static_cast<int>(cause)] = value; };
        const Scalar none = fits_.nothing.of_all();
        const Scalar contact = std::max(fits_.force.evidence().of_all() - none, gain_of_some(fits_.push));
        const bool passed = ended();
        const Scalar permanent = passed && peak_power_ > large ? -duration_penalty : Scalar(0);
        set(Cause::unknown, 0);
        set(Cause::payload, payload_possible()
                                ? permanent + trust * (fits_.payload.evidence().of_all() - none)
                                : -impossible);
        set(Cause::friction, has_friction_ ? permanent + trust * gain_of_some(fits_.friction) : -impossible);
        set(Cause::bias, permanent + trust * gain_of_some(fits_.bias));
        set(Cause::contact, trust * contact - (passed ? Scalar(0) : duration_penalty));
        set(Cause::frozen, -impossible);
    }

    static void rank(const Scalar* weights, Scalar total, Change<Scalar, m>& change) noexcept {
        int best = 0;
        for (int c = 1; c < cause_count; ++c) {
            best = weights[c] > weights[best] ? c : best;
        }
        int second = best == 0 ? 1 : 0;
        for (int c = 0; c < cause_count; ++c) {
            second = c != best && weights[c] > weights[second] ? c : second;
        }
        change.cause = static_cast<Cause>(best);
        change.runner_up = static_cast<Cause>(second);
        change.confidence = weights[best] / total;
        change.runner_up_confidence = weights[second] / total;
    }

    void describe(int channel, Change<Scalar, m>& change) const noexcept {
        change.where = -1;
        std::fill_n(change.size, 4, Scalar(0));
        switch (change.cause) {
        case Cause::payload:
            for (int i = 0; i < payload_columns; ++i) {
                change.size[i] = fits_.payload.parameters()[i] * fits_.payload_scale[i];
            }
            break;
        case Cause::friction:
            change.where = best_output(fits_.friction);
            for (int i = 0; i < friction_columns; ++i) {
                change.size[i] = fits_.friction[change.where].parameters()[i] * fits_.unit(change.where);
            }
            break;
        case Cause::bias:
            describe_bias(change);
            break;
        case Cause::contact:
            describe_contact(change);
            break;
        case Cause::frozen:
            change.where = channel;
            break;
        case Cause::unknown:
            break;
        }
    }

    void describe_bias(Change<Scalar, m>& change) const noexcept {
        change.where = best_output(fits_.bias);
        for (int k = 0; k < outputs_; ++k) {
            const bool moved = gain(fits_.bias, k) > 0 || k == change.where;
            change.bias[k] = moved ? *fits_.bias[k].parameters() * fits_.unit(k) : Scalar(0);
        }
    }

    void describe_contact(Change<Scalar, m>& change) const noexcept {
        if (fits_.force.evidence().of_all() - fits_.nothing.of_all() >= gain_of_some(fits_.push)) {
            std::copy_n(mean_force_, force_columns, change.size);
            return;
        }
        change.where = best_output(fits_.push);
        change.size[0] = -mean_push_[change.where];
    }

    [[no_unique_address]] Extent<m> outputs_;
    bool has_friction_;
    CauseFits<Scalar, m> fits_;
    Storage<Scalar, m> recent_; ///< mean square of the recent residuals, relative to the noise
    Scalar peak_power_ = 0;     ///< largest `recent_` since the onset, over all outputs
    Scalar energy_ = 0;         ///< sum of squared residuals since the onset, relative to the noise
    Storage<Scalar, m> mean_push_;
    Scalar mean_force_[force_columns] = {};
};

} // namespace dfdyn
