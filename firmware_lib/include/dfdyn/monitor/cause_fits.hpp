// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/ud_covariance.hpp"
#include "dfdyn/monitor/block_noise.hpp"
#include "dfdyn/monitor/output_block.hpp"

#include <cmath>

namespace dfdyn {

/// Log-evidence of one-step-ahead predictions of m outputs: the logarithm of the product of their densities
/// (prequential evidence). Each output's noise variance is unknown, with an inverse gamma prior around 1 that
/// weighs as much as `noise_weight` samples.
template <class Scalar, int m>
class Evidence {
  public:
    static constexpr Scalar noise_weight = 4;
    static constexpr std::int64_t cost = function_cost + 3; ///< of `add`

    explicit Evidence(Extent<m> outputs) noexcept
        : squares_(Storage<Scalar, m>::zeros(outputs)), logarithms_(squares_), instants_(squares_) {}

    void restart() noexcept {
        for (int k = 0; k < squares_.size(); ++k) {
            squares_[k] = logarithms_[k] = instants_[k] = 0;
        }
    }

    /// Adds an error of output k, 0 ≤ k < m, and its variance > 0, both relative to the noise.
    void add(int k, Scalar error, Scalar variance) noexcept {
        using std::log;
        squares_[k] += error * error / variance;
        logarithms_[k] += log(variance);
        instants_[k] += 1;
    }

    /// Returns the log-evidence of output k, up to a constant common to all predictions of the same data.
    [[nodiscard]] Scalar of(int k) const noexcept {
        using std::log;
        const Scalar weight = (noise_weight + instants_[k]) / 2;
        return -logarithms_[k] / 2 - weight * log((noise_weight + squares_[k]) / 2);
    }

    [[nodiscard]] Scalar of_all() const noexcept {
        Scalar total = 0;
        for (int k = 0; k < squares_.size(); ++k) {
            total += of(k);
        }
        return total;
    }

  private:
    Storage<Scalar, m> squares_;    ///< Σ e²/S
    Storage<Scalar, m> logarithms_; ///< Σ log S
    Storage<Scalar, m> instants_;
};

/// Fits p columns to m outputs by recursive least squares over the rows since `restart`, with the
/// log-evidence of the fit.
///
/// The prior of each parameter is N(0, `prior_variance`), for columns scaled to the noise. Each row h is
/// predicted before it is learned, with the error e and the variance S = 1 + h'Ph. Parameters that explain
/// nothing thus reduce the evidence (Occam factor). `forgets`: exponential forgetting, for temporary causes.
/// Memory: about p²/2 + 5 p + 3 m scalars.
template <class Scalar, int p, int m, bool forgets>
class HypothesisFit {
  public:
    static constexpr Scalar prior_variance = 400;
    static constexpr Scalar forgetting = Scalar(0.8); ///< factor per block

    HypothesisFit() noexcept : HypothesisFit(Extent<m>{}) {}
    explicit HypothesisFit(Extent<m> outputs) noexcept
        : outputs_(outputs), learner_(constants, {}, {}), evidence_(outputs) {}

    void restart() noexcept {
        learner_.reset();
        evidence_.restart();
    }

    /// Adds one block: `rows` (m × p) and `targets` (m), in standard deviations of the noise.
    void add(const Scalar* rows, const Scalar* targets) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            const Scalar* row = rows + k * p;
            Scalar mean = 0;
            learner_.predict(row, &mean);
            learner_.begin_row(row, targets + k, 1, k + 1 == outputs_);
            Budget all = Budget::unlimited();
            learner_.advance(all);
            evidence_.add(k, targets[k] - mean, learner_.last_variance_ratio());
        }
    }

    [[nodiscard]] const Evidence<Scalar, m>& evidence() const noexcept { return evidence_; }
    /// Returns the p parameters, for the scaled columns.
    [[nodiscard]] const Scalar* parameters() const noexcept { return learner_.weights(0); }
    /// Returns the standard deviation of parameter i, in the same units. Cost: `deviation_cost`
    /// multiply-adds.
    [[nodiscard]] Scalar deviation(int i) const noexcept {
        using std::sqrt;
        return sqrt(learner_.parameter_variance(i));
    }
    static constexpr int deviation_cost = function_cost + 2 * p;

    /// Returns the maximum multiply-adds of `add`.
    static constexpr std::int64_t cost(int outputs) noexcept {
        const Cost row = Learner::cost(p, 1);
        return outputs * (row.predict + row.learn + Evidence<Scalar, m>::cost) + row.forget;
    }

  private:
    using Learner = UdCovariance<Scalar, p, 1>;
    static constexpr
        typename Learner::Constants constants{prior_variance, forgets ? forgetting : Scalar(1), nullptr};

    [[no_unique_address]] Extent<m> outputs_;
    Learner learner_;
    Evidence<Scalar, m> evidence_;
};

/// Fits every cause of a change to the residuals since its onset.
///
/// The residuals belong to a prediction that does not learn the change. Their noise is estimated in the
/// absence of a change (`BlockNoise`). Residuals and columns pass through the same whitening filter
/// (D. Cochrane and G. H. Orcutt, 1949). Columns are scaled to the noise, so that all have the same prior.
///
/// Cost per block while fitting: `cost(m)`.
template <class Scalar, int m>
class CauseFits {
  public:
    using Block = OutputBlock<Scalar>;
    using Speed = SpeedClasses<Scalar>;
    template <int p, bool forgets>
    using OfOutput = HypothesisFit<Scalar, p, 1, forgets>;

    explicit CauseFits(Extent<m> outputs) noexcept
        : nothing(outputs), payload(outputs), force(outputs),
          friction(Storage<OfOutput<friction_columns, false>, m>::zeros(outputs)),
          bias(Storage<OfOutput<1, false>, m>::zeros(outputs)),
          push(Storage<OfOutput<1, true>, m>::zeros(outputs)), outputs_(outputs),
          noise_(Storage<BlockNoise<Scalar>, m>::zeros(outputs)),
          whitening_(Storage<Whitening<Scalar>, m>::zeros(outputs)),
          targets_(Storage<Scalar, m>::zeros(outputs)),
          rows_(Rows::zeros(extent<product(m, payload_columns)>(outputs * payload_columns))) {}

    /// Adds a block without a change and its predecessor (null after a gap) to the noise estimates.
    void learn(const Block* now, const Block* before, const Speed& speed) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            const Block& other = before == nullptr ? now[k] : before[k];
            const int last = before == nullptr ? -1 : speed.of(other.speed);
            noise_[k].learn(now[k].residual, other.residual, speed.of(now[k].speed), last);
        }
    }
    /// Learns the noise again, starting from the present estimates.
    void relearn() noexcept {
        for (BlockNoise<Scalar>& noise : noise_) {
            noise.relearn();
        }
    }

    /// Starts the fits. `block_at(b)`, 0 ≤ b < `count`: the stored blocks, which scale the columns.
    template <class BlockAt>
    void start(const BlockAt& block_at, int count) noexcept {
        scale_columns(block_at, count);
        nothing.restart();
        payload.restart();
        force.restart();
        for (int k = 0; k < outputs_; ++k) {
            friction[k].restart();
            bias[k].restart();
            push[k].restart();
        }
    }

    /// Returns the maximum multiply-adds of `start`.
    static constexpr std::int64_t cost_of_start(int outputs, int count) noexcept {
        constexpr int columns = payload_columns + force_columns;
        return std::int64_t{outputs} * (function_cost + 2 + 2 * columns * std::int64_t{count}) +
               columns * (function_cost + 1);
    }

    /// Adds a block since the onset and its predecessor, m values each. Cost: `cost`.
    void add(const Block* now, const Block* before, const Speed& speed) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            const Whitening<Scalar> whitening = whitening_of(k, now, before, speed);
            const Scalar scale = unit(k);
            whitening_[k] = whitening;
            targets_[k] = whitening.of(now[k].residual, before[k].residual);
            nothing.add(k, targets_[k], 1);
            const Scalar constant = scale * whitening.of(1, 1);
            bias[k].add(&constant, &targets_[k]);
            push[k].add(&constant, &targets_[k]);
            const Scalar friction_row[friction_columns] = {
                scale * whitening.of(now[k].friction[0], before[k].friction[0]),
                scale * whitening.of(now[k].friction[1], before[k].friction[1])};
            friction[k].add(friction_row, &targets_[k]);
        }
        add_shared(payload, payload_scale, &Block::payload, now, before);
        add_shared(force, force_scale, &Block::force, now, before);
    }

    /// Returns the largest whitened residual of a block, in standard deviations.
    [[nodiscard]] Scalar largest(const Block* now, const Block* before, const Speed& speed) const noexcept {
        Scalar most = 0;
        for (int k = 0; k < outputs_; ++k) {
            using std::abs;
            const Scalar one =
                abs(whitening_of(k, now, before, speed).of(now[k].residual, before[k].residual));
            most = std::max(most, one);
        }
        return most;
    }

    [[nodiscard]] const BlockNoise<Scalar>& noise(int output) const noexcept { return noise_[output]; }
    /// Returns the unit of the parameters of a bias, a friction or a push, in output units.
    [[nodiscard]] Scalar unit(int output) const noexcept { return noise_[output].smallest(); }

    /// Returns the maximum multiply-adds of `add`.
    static constexpr std::int64_t cost(int outputs) noexcept {
        const std::int64_t own = OfOutput<1, false>::cost(1) + OfOutput<1, true>::cost(1) +
                                 OfOutput<friction_columns, false>::cost(1);
        return outputs * (own + Evidence<Scalar, m>::cost + 4 * function_cost + 60) +
               HypothesisFit<Scalar, payload_columns, m, false>::cost(outputs) +
               HypothesisFit<Scalar, force_columns, m, true>::cost(outputs);
    }

    // Fits with forgetting follow the start and the end of a push.
    Evidence<Scalar, m> nothing;
    HypothesisFit<Scalar, payload_columns, m, false> payload;
    HypothesisFit<Scalar, force_columns, m, true> force;
    Storage<OfOutput<friction_columns, false>, m> friction;
    Storage<OfOutput<1, false>, m> bias;
    Storage<OfOutput<1, true>, m> push;
    /// Units of the parameters: kg, kg·m or N.
    Scalar payload_scale[payload_columns] = {}, force_scale[force_columns] = {};

  private:
    using Rows = Storage<Scalar, product(m, payload_columns)>;

    [[nodiscard]] Whitening<Scalar> whitening_of(int k, const Block* now, const Block* before,
                                                 const Speed& speed) const noexcept {
        return noise_[k].whitening(speed.of(now[k].speed), speed.of(before[k].speed));
    }

    template <class BlockAt>
    void scale_columns(const BlockAt& block_at, int count) noexcept {
        Scalar powers[payload_columns + force_columns] = {};
        for (int k = 0; k < outputs_; ++k) {
            const Scalar one = unit(k);
            const Scalar weight = one > 0 ? 1 / (one * one) : Scalar(0);
            for (int b = 0; b < count; ++b) {
                const Block& block = block_at(b)[k];
                for (int i = 0; i < payload_columns; ++i) {
                    powers[i] += weight * block.payload[i] * block.payload[i];
                }
                for (int i = 0; i < force_columns; ++i) {
                    powers[payload_columns + i] += weight * block.force[i] * block.force[i];
                }
            }
        }
        const auto rows = static_cast<Scalar>(count * int{outputs_});
        using std::sqrt;
        for (int i = 0; i < payload_columns + force_columns; ++i) {
            const Scalar scale = powers[i] > 0 ? sqrt(rows / powers[i]) : Scalar(0);
            (i < payload_columns ? payload_scale[i] : force_scale[i - payload_columns]) = scale;
        }
    }

    /// Adds a block to a fit with parameters common to all outputs.
    template <class Fit, int p>
    void add_shared(Fit& fit, const Scalar (&scale)[p], Scalar (Block::*columns)[p], const Block* now,
                    const Block* before) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            for (int i = 0; i < p; ++i) {
                rows_[p * k + i] = scale[i] * whitening_[k].of((now[k].*columns)[i], (before[k].*columns)[i]);
            }
        }
        fit.add(rows_.data(), targets_.data());
    }

    [[no_unique_address]] Extent<m> outputs_;
    Storage<BlockNoise<Scalar>, m> noise_;
    Storage<Whitening<Scalar>, m> whitening_;
    Storage<Scalar, m> targets_;
    Rows rows_;
};

} // namespace dfdyn
