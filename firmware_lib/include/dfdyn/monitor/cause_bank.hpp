// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/block_scale.hpp"
#include "dfdyn/monitor/cause.hpp"
#include "dfdyn/monitor/cause_fit.hpp"
#include "dfdyn/monitor/tool_columns.hpp"

namespace dfdyn {

inline constexpr int friction_columns = 2; ///< Coulomb, viscous; of the output's own joint

/// What a block says of one output: the mean residual, and the means of the causes' columns.
template <class Scalar>
struct OutputBlock {
    Scalar residual;
    Scalar payload[payload_columns];
    Scalar force[force_columns];
    Scalar friction[friction_columns];
};

/// Fits every cause of a change to the residuals since its onset, and weighs them against each other.
///
/// The residuals are those of a prediction that does not learn the change. Their usual scale and
/// autocorrelation are learned while nothing happens; residuals and columns then pass through the same filter
/// x(t) - a x(t-1), which leaves nearly white noise (D. Cochrane and G. H. Orcutt, 1949). Each cause is a
/// `CauseFit`; a bias, a friction or a push at a joint may show on some outputs only, so for each output the
/// better of "with" and "without" counts, at the price of log(2 m). The contact's fits forget, so that they
/// follow a push and its end. Evidence counts a share `trust`: real residuals are neither Gaussian nor quite
/// white, and columns are not exact.
///
/// Cost per block while fitting: about m (40 m² + 60 m + 400) multiply-adds.
template <class Scalar, int m>
class CauseBank {
  public:
    static constexpr Scalar trust = Scalar(0.2);
    /// log: for a contact that has not ended so far.
    static constexpr Scalar goes_on = 6;

    /// `friction`: whether outputs are the torques of joints of their own.
    CauseBank(Extent<m> outputs, bool friction) noexcept
        : outputs_(outputs), has_friction_(friction), usual_(Storage<BlockScale<Scalar>, m>::zeros(outputs)),
          nothing_({}, outputs, false), payload_({}, outputs, false), force_({}, outputs, true),
          friction_(extent<friction_size>(friction_columns * outputs), outputs, false),
          bias_(outputs, outputs, false), push_(outputs, outputs, true),
          rows_(Rows::zeros(extent<rows_size(m)>(rows_size(outputs)))), targets_(Outputs::zeros(outputs)),
          recent_(targets_), peaks_(targets_) {}

    /// A block while nothing happens.
    void learn(const OutputBlock<Scalar>* block) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            usual_[k].learn(block[k].residual);
        }
    }

    /// Begins to fit. `blocks`: what there is of the past, `count` × m, for the size of the columns.
    template <class BlockAt>
    void start(const BlockAt& block_at, int count) noexcept {
        scale_columns(block_at, count);
        nothing_.restart();
        payload_.restart();
        force_.restart();
        friction_.restart();
        bias_.restart();
        push_.restart();
        for (int k = 0; k < outputs_; ++k) {
            recent_[k] = peaks_[k] = 0;
        }
        force_peak_[0] = force_peak_[1] = force_peak_[2] = 0;
    }

    /// A block since the onset, and the one before it.
    void add(const OutputBlock<Scalar>* now, const OutputBlock<Scalar>* before) noexcept {
        fit_common(now, before);
        fit_own(now, before);
        note_peaks();
    }

    /// Fills in cause, runner-up, confidence and size. `frozen`: log odds of a channel that repeats itself,
    /// 0 for none, and which.
    void judge(Scalar frozen, int channel, Change<Scalar, m>& change) const noexcept {
        Scalar logs[cause_count];
        weigh(logs);
        Scalar best = *std::max_element(logs, logs + cause_count);
        logs[static_cast<int>(Cause::frozen)] = frozen > 0 ? best + frozen : best - impossible;
        best = std::max(best, logs[static_cast<int>(Cause::frozen)]);
        Scalar total = 0;
        for (Scalar& log : logs) {
            log = std::exp(log - best);
            total += log;
        }
        rank(logs, total, change);
        describe(channel, change);
    }

    [[nodiscard]] const BlockScale<Scalar>& usual(int output) const noexcept { return usual_[output]; }

    void adopt() noexcept {
        for (BlockScale<Scalar>& usual : usual_) {
            usual.restart();
        }
    }

  private:
    static constexpr int friction_size = product(friction_columns, m);
    static constexpr Scalar impossible = 50;
    using Outputs = Storage<Scalar, m>;

    /// The rows of the largest fit.
    static constexpr int rows_size(int outputs) noexcept {
        return outputs == dynamic ? dynamic : outputs * std::max(friction_columns * outputs, payload_columns);
    }
    using Rows = Storage<Scalar, rows_size(m)>;

    template <class BlockAt>
    void scale_columns(const BlockAt& block_at, int count) noexcept {
        Scalar powers[payload_columns + force_columns] = {};
        for (int b = 0; b < count; ++b) {
            const OutputBlock<Scalar>* block = block_at(b);
            for (int k = 0; k < outputs_; ++k) {
                const Scalar weight = 1 / (usual_[k].scale() * usual_[k].scale());
                for (int i = 0; i < payload_columns; ++i) {
                    powers[i] += weight * block[k].payload[i] * block[k].payload[i];
                }
                for (int i = 0; i < force_columns; ++i) {
                    powers[payload_columns + i] += weight * block[k].force[i] * block[k].force[i];
                }
            }
        }
        const Scalar rows = static_cast<Scalar>(count) * static_cast<Scalar>(outputs_);
        for (int i = 0; i < payload_columns + force_columns; ++i) {
            column_scale_[i] = powers[i] > 0 ? std::sqrt(rows / powers[i]) : Scalar(0);
        }
    }

    /// What the filter leaves of a number of output k, in units of the noise.
    [[nodiscard]] Scalar filtered(int k, Scalar now, Scalar before) const noexcept {
        const Scalar a = usual_[k].autocorrelation();
        return (now - a * before) / (usual_[k].scale() * std::sqrt(1 - a * a));
    }

    /// Parameters that all outputs share: payload, force, and none at all.
    void fit_common(const OutputBlock<Scalar>* now, const OutputBlock<Scalar>* before) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            targets_[k] = filtered(k, now[k].residual, before[k].residual);
            const Scalar share = now[k].residual / usual_[k].scale();
            recent_[k] += (std::min(share * share, Scalar(16)) - recent_[k]) / 5;
            rows_[k] = 0;
        }
        nothing_.add(rows_.data(), targets_.data());
        for (int k = 0; k < outputs_; ++k) {
            for (int i = 0; i < payload_columns; ++i) {
                rows_[payload_columns * k + i] =
                    column_scale_[i] * filtered(k, now[k].payload[i], before[k].payload[i]);
            }
        }
        payload_.add(rows_.data(), targets_.data());
        for (int k = 0; k < outputs_; ++k) {
            for (int i = 0; i < force_columns; ++i) {
                rows_[force_columns * k + i] =
                    column_scale_[payload_columns + i] * filtered(k, now[k].force[i], before[k].force[i]);
            }
        }
        force_.add(rows_.data(), targets_.data());
    }

    /// Parameters of each output's own: friction, bias, a push at a joint.
    void fit_own(const OutputBlock<Scalar>* now, const OutputBlock<Scalar>* before) noexcept {
        if (has_friction_) {
            clear_rows(friction_columns * outputs_);
            for (int k = 0; k < outputs_; ++k) {
                for (int i = 0; i < friction_columns; ++i) {
                    rows_[friction_columns * (outputs_ * k + k) + i] =
                        friction_unit(k) * filtered(k, now[k].friction[i], before[k].friction[i]);
                }
            }
            friction_.add(rows_.data(), targets_.data());
        }
        clear_rows(outputs_);
        for (int k = 0; k < outputs_; ++k) {
            rows_[outputs_ * k + k] = usual_[k].scale() * filtered(k, 1, 1);
        }
        bias_.add(rows_.data(), targets_.data());
        push_.add(rows_.data(), targets_.data());
    }

    void clear_rows(int columns) noexcept {
        for (int element = 0; element < columns * outputs_; ++element) {
            rows_[element] = 0;
        }
    }

    /// A parameter of 1 is as much friction as the noise is large.
    [[nodiscard]] Scalar friction_unit(int k) const noexcept { return usual_[k].scale(); }

    void note_peaks() noexcept {
        Scalar force[force_columns];
        force_parameters(force);
        if (norm_square(force) > norm_square(force_peak_)) {
            std::copy_n(force, force_columns, force_peak_);
        }
        for (int k = 0; k < outputs_; ++k) {
            const Scalar push = push_.parameters()[k];
            peaks_[k] = std::abs(push) > std::abs(peaks_[k]) ? push : peaks_[k];
        }
    }

    void force_parameters(Scalar* force) const noexcept {
        for (int i = 0; i < force_columns; ++i) {
            force[i] = force_.parameters()[i] * column_scale_[payload_columns + i];
        }
    }

    [[nodiscard]] static Scalar norm_square(const Scalar* v) noexcept {
        return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    }

    template <class Fit>
    [[nodiscard]] Scalar evidence_of_all(const Fit& fit) const noexcept {
        Scalar total = 0;
        for (int k = 0; k < outputs_; ++k) {
            total += fit.evidence(k);
        }
        return total;
    }

    template <class Fit>
    [[nodiscard]] Scalar gain(const Fit& fit, int k) const noexcept {
        return fit.evidence(k) - nothing_.evidence(k) - std::log(2 * static_cast<Scalar>(outputs_));
    }

    /// The output on which the fit gains most.
    template <class Fit>
    [[nodiscard]] int best_output(const Fit& fit) const noexcept {
        int best = 0;
        for (int k = 1; k < outputs_; ++k) {
            best = gain(fit, k) > gain(fit, best) ? k : best;
        }
        return best;
    }

    /// Of the outputs where the fit is better than none, and of the best one anyway.
    template <class Fit>
    [[nodiscard]] Scalar evidence_of_some(const Fit& fit) const noexcept {
        Scalar total = evidence_of_all(nothing_) + std::min(gain(fit, best_output(fit)), Scalar(0));
        for (int k = 0; k < outputs_; ++k) {
            total += std::max(gain(fit, k), Scalar(0));
        }
        return total;
    }

    [[nodiscard]] bool ended() const noexcept {
        bool all = true;
        for (int k = 0; k < outputs_; ++k) {
            all = all && recent_[k] < 4;
        }
        return all;
    }

    void weigh(Scalar* logs) const noexcept {
        const auto set = [logs](Cause cause, Scalar value) { logs[static_cast<int>(cause)] = value; };
        const Scalar none = evidence_of_all(nothing_);
        set(Cause::unknown, 0);
        set(Cause::payload, trust * (evidence_of_all(payload_) - none));
        set(Cause::friction, has_friction_ ? trust * (evidence_of_some(friction_) - none) : -impossible);
        set(Cause::bias, trust * (evidence_of_some(bias_) - none));
        set(Cause::contact, trust * (std::max(evidence_of_all(force_), evidence_of_some(push_)) - none) -
                                (ended() ? Scalar(0) : goes_on));
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
        for (Scalar& value : change.size) {
            value = 0;
        }
        if (change.cause == Cause::payload) {
            for (int i = 0; i < payload_columns; ++i) {
                change.size[i] = payload_.parameters()[i] * column_scale_[i];
            }
        } else if (change.cause == Cause::friction) {
            change.where = best_output(friction_);
            for (int i = 0; i < friction_columns; ++i) {
                change.size[i] =
                    friction_.parameters()[friction_columns * change.where + i] * friction_unit(change.where);
            }
        } else if (change.cause == Cause::bias) {
            change.where = best_output(bias_);
            for (int k = 0; k < outputs_; ++k) {
                change.bias[k] = gain(bias_, k) > 0 || k == change.where
                                     ? bias_.parameters()[k] * usual_[k].scale()
                                     : Scalar(0);
            }
        } else if (change.cause == Cause::contact) {
            describe_contact(change);
        } else if (change.cause == Cause::frozen) {
            change.where = channel;
        }
    }

    void describe_contact(Change<Scalar, m>& change) const noexcept {
        if (evidence_of_all(force_) >= evidence_of_some(push_)) {
            std::copy_n(force_peak_, force_columns, change.size);
            return;
        }
        change.where = best_output(push_);
        change.size[0] = -peaks_[change.where] * usual_[change.where].scale();
    }

    [[no_unique_address]] Extent<m> outputs_;
    bool has_friction_;
    Storage<BlockScale<Scalar>, m> usual_;
    CauseFit<Scalar, 1, m> nothing_;
    CauseFit<Scalar, payload_columns, m> payload_;
    CauseFit<Scalar, force_columns, m> force_;
    CauseFit<Scalar, friction_size, m> friction_;
    CauseFit<Scalar, m, m> bias_, push_;
    Rows rows_;
    Outputs targets_;
    Outputs recent_; ///< mean square of the last residuals, in units of the noise
    Outputs peaks_;
    Scalar column_scale_[payload_columns + force_columns] = {};
    Scalar force_peak_[force_columns] = {};
};

} // namespace dfdyn
