// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/ud_covariance.hpp"

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

} // namespace dfdyn
