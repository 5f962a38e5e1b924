// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/ud_covariance.hpp"

#include <cmath>

namespace dfdyn {

/// How well m outputs were predicted, one step after the other: the logarithm of the product of the
/// predictions' densities. Each output's noise has an unknown variance, inverse gamma about 1 as if seen
/// `noise_weight` times before; what a column explains is thereby judged against what it leaves.
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

    /// Of output k: an error, and its variance in units of the noise's.
    void add(int k, Scalar error, Scalar variance) noexcept {
        using std::log;
        squares_[k] += error * error / variance;
        logarithms_[k] += log(variance);
        instants_[k] += 1;
    }

    /// Up to what all predictions of the same outputs have in common. A logarithm.
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

/// How well p columns explain m outputs: recursive least squares over the rows since `restart`, and the
/// evidence that comes with it.
///
/// The parameters' prior is N(0, `prior_variance`) each, in units of columns scaled to the noise. Rows come
/// one after the other, each predicted before it is folded in: with the error e and the variance S = 1 +
/// h'Ph of each, parameters that do not explain cost by themselves. `forgets`: for what comes and goes.
/// Memory about p²/2 + 5 p + 3 m.
template <class Scalar, int p, int m, bool forgets>
class CauseFit {
  public:
    static constexpr Scalar prior_variance = 400;
    static constexpr Scalar forgetting = Scalar(0.8); ///< per instant

    CauseFit() noexcept : CauseFit(Extent<m>{}) {}
    explicit CauseFit(Extent<m> outputs) noexcept
        : outputs_(outputs), learner_(constants, {}, {}), evidence_(outputs) {}

    void restart() noexcept {
        learner_.reset();
        evidence_.restart();
    }

    /// One instant: `rows` (m × p) and `targets` (m), in units of the noise.
    void add(const Scalar* rows, const Scalar* targets) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            const Scalar* row = rows + k * p;
            Scalar mean = 0;
            learner_.predict(row, &mean);
            learner_.begin_row(row, targets + k, 1, k + 1 == outputs_);
            Budget all = Budget::unlimited();
            learner_.advance(all);
            evidence_.add(k, targets[k] - mean, learner_.last_ratio());
        }
    }

    [[nodiscard]] const Evidence<Scalar, m>& evidence() const noexcept { return evidence_; }
    /// In units of the scaled columns, p values.
    [[nodiscard]] const Scalar* parameters() const noexcept { return learner_.weights(0); }
    /// Returns the standard deviation of parameter i, in the same units. Cost: `deviation_cost`
    /// multiply-adds.
    [[nodiscard]] Scalar deviation(int i) const noexcept {
        using std::sqrt;
        return sqrt(learner_.parameter_variance(i));
    }
    static constexpr int deviation_cost = function_cost + 2 * p;

    /// Multiply-adds of `add`, at most.
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
