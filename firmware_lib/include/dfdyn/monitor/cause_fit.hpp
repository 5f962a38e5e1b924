// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/ud_covariance.hpp"

#include <cmath>

namespace dfdyn {

/// How well p columns explain m outputs: recursive least squares over the rows since `restart`, and the
/// evidence that comes with it.
///
/// The parameters' prior is N(0, `prior_variance`) each, in units of columns scaled to the noise. Rows come
/// one after the other, each predicted before it is folded in: with the error e and the variance S = 1 +
/// h'Ph of each, the product of these predictions is the marginal likelihood, so parameters that do not
/// explain cost by themselves. Each output's noise has an unknown variance, inverse gamma about 1 as if seen
/// `noise_weight` times before; what a column explains is thereby judged against what it leaves.
///
/// Cost per instant: m (2 p² + 5 p) multiply-adds and m logarithms. Memory about p²/2 + 5 p + 2 m.
template <class Scalar, int p, int m>
class CauseFit {
  public:
    static constexpr Scalar prior_variance = 400;
    static constexpr Scalar noise_weight = 4;

    /// `forgetting`: per instant; below 1 for what comes and goes.
    CauseFit(Extent<p> parameters, Extent<m> outputs, bool forgets) noexcept
        : parameters_(parameters), outputs_(outputs),
          learner_(forgets ? passing : lasting, parameters, {}, outputs),
          squares_(Storage<Scalar, m>::zeros(outputs)), logarithms_(squares_) {}

    void restart() noexcept {
        learner_.reset();
        for (int k = 0; k < outputs_; ++k) {
            squares_[k] = logarithms_[k] = 0;
        }
        instants_ = 0;
    }

    /// One instant: `rows` (m × p) and `targets` (m), in units of the noise.
    void add(const Scalar* rows, const Scalar* targets) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            const Scalar* row = rows + k * parameters_;
            Scalar mean = 0;
            learner_.predict(row, &mean);
            learner_.begin_row(row, targets + k, 1, k + 1 == outputs_);
            Budget all = Budget::unlimited();
            learner_.advance(all);
            const Scalar variance = learner_.last_ratio();
            const Scalar error = targets[k] - mean;
            squares_[k] += error * error / variance;
            logarithms_[k] += std::log(variance);
        }
        instants_ += 1;
    }

    /// Logarithm of the evidence that output k gives, up to what all fits of the same rows have in common.
    [[nodiscard]] Scalar evidence(int k) const noexcept {
        const Scalar weight = (noise_weight + instants_) / 2;
        return -logarithms_[k] / 2 - weight * std::log((noise_weight + squares_[k]) / 2);
    }

    /// In units of the scaled columns, p values.
    [[nodiscard]] const Scalar* parameters() const noexcept { return learner_.weights(0); }

  private:
    using Learner = UdCovariance<Scalar, p, 1>;
    static constexpr typename Learner::Constants lasting{prior_variance, 1, nullptr};
    static constexpr typename Learner::Constants passing{prior_variance, Scalar(0.8), nullptr};

    [[no_unique_address]] Extent<p> parameters_;
    [[no_unique_address]] Extent<m> outputs_;
    Learner learner_;
    Storage<Scalar, m> squares_;    ///< Σ e²/S
    Storage<Scalar, m> logarithms_; ///< Σ log S
    Scalar instants_ = 0;
};

} // namespace dfdyn
