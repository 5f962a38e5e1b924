// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/ud_covariance.hpp"

namespace dfdyn {

/// Recursive least squares of p parameters common to all outputs: y_k = h_k'π + e_k, k = 1 … m, with one row
/// h_k per output, as for a rigid body. The m rows of a sample are folded in one after the other, each
/// exactly; forgetting is applied once per sample. Sliced learning can stop between rows: π is then the
/// estimate from the rows learned so far. Memory about p²/2 + (m+5) p scalars.
template <class Scalar, int p, int m>
class CommonParameters {
  public:
    static constexpr int identity = 4;
    using Constants = LearnerConstants<Scalar, p, 1>;

    CommonParameters(const Constants& constants, Extent<p> parameters, Extent<m> outputs) noexcept
        : parameters_(parameters), outputs_(outputs), learner_(constants, parameters, {}, outputs),
          rows_(Rows::zeros(extent<product(m, p)>(outputs * parameters))), targets_(Targets::zeros(outputs)),
          variances_(Targets::zeros(outputs)), next_(2 * outputs) {}

    void reset() noexcept {
        learner_.reset();
        for (Scalar& value : rows_) {
            value = 0;
        }
        for (int k = 0; k < outputs_; ++k) {
            targets_[k] = variances_[k] = 0;
        }
        noise_variance_ = 1;
        next_ = 2 * outputs_;
    }

    /// Computes the means h_k'π of `rows` (m × p), m values.
    void predict(const Scalar* rows, Scalar* means) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            learner_.predict(rows + k * parameters_, means + k);
        }
    }

    /// Computes h_k'P h_k of each of the `rows` (m × p), m values. O(m p²).
    void variances(const Scalar* rows, Scalar* variances) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            variances[k] = learner_.variance(rows + k * parameters_);
        }
    }

    [[nodiscard]] bool idle() const noexcept { return !sample_pending() && learner_.idle(); }
    [[nodiscard]] bool sample_pending() const noexcept {
        return next_ < 2 * outputs_ || learner_.sample_pending();
    }

    /// Begins to learn the rows (m × p) and m targets of a sample, all with the same noise variance. Only
    /// when idle.
    void begin(const Scalar* rows, const Scalar* targets, Scalar noise_variance) noexcept {
        for (int element = 0; element < outputs_ * parameters_; ++element) {
            rows_[element] = rows[element];
        }
        for (int k = 0; k < outputs_; ++k) {
            targets_[k] = targets[k];
        }
        noise_variance_ = noise_variance;
        next_ = 0;
    }

    /// Begins to reset the covariance to the prior's; the parameters stay. Only when idle.
    void reset_covariance() noexcept { learner_.reset_covariance(); }

    /// Continues the present task within the budget; returns true when nothing is left to do.
    bool advance(Budget& budget) noexcept { return learn(budget) && learner_.advance(budget); }

    /// Same, but leaves the work of forgetting to `advance`.
    bool learn(Budget& budget) noexcept {
        while (learner_.learn(budget)) {
            if (next_ == 2 * outputs_) {
                return true;
            }
            if (next_ < outputs_) {
                if (!budget.spend(UdFactor<Scalar, p>::variance_cost(parameters_))) {
                    return false;
                }
                variances_[next_] = learner_.variance(rows_.data() + next_ * parameters_);
            } else {
                const int k = next_ - outputs_;
                learner_.begin_row(rows_.data() + k * parameters_, &targets_[k], noise_variance_,
                                   k + 1 == outputs_);
            }
            ++next_;
        }
        return false;
    }

    /// Returns h_k'P h_k of the last learned rows, before any of them was learned; m values.
    [[nodiscard]] const Scalar* last_variances() const noexcept { return variances_.data(); }

    /// Returns π, p values.
    [[nodiscard]] const Scalar* parameters() const noexcept { return learner_.weights(0); }
    [[nodiscard]] const UdCovariance<Scalar, p, 1>& learner() const noexcept { return learner_; }

    [[nodiscard]] static constexpr Cost cost(int parameters, int outputs) noexcept {
        const Cost row = UdCovariance<Scalar, p, 1>::cost(parameters, 1);
        const std::int64_t variance = UdFactor<Scalar, p>::variance_cost(parameters);
        return {.predict = outputs * row.predict,
                .variance = outputs * row.variance,
                .learn = outputs * (variance + row.learn),
                .forget = row.forget,
                .largest_step = std::max(variance, row.largest_step),
                .reset_covariance = row.reset_covariance};
    }

    [[nodiscard]] static constexpr std::int64_t state_bytes(int parameters, int outputs) noexcept {
        return UdCovariance<Scalar, p, 1>::state_bytes(parameters, 1) +
               storage_bytes<Scalar>(std::int64_t{outputs} * parameters) + 2 * storage_bytes<Scalar>(outputs);
    }

    /// Returns the maximum stack bytes over all calls.
    [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept {
        return frame_bytes + UdCovariance<Scalar, p, 1>::stack_bytes();
    }

    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        UdCovariance<Scalar, p, 1>::visit_state(self.learner_, visitor);
        visitor.array(self.rows_.data(), self.rows_.size());
        visitor.array(self.targets_.data(), self.targets_.size());
        visitor.array(self.variances_.data(), self.variances_.size());
        visitor.positive_array(&self.noise_variance_, 1);
        visitor.ranged(self.next_, 0, 2 * self.outputs_);
    }

  private:
    using Rows = Storage<Scalar, product(m, p)>;
    using Targets = Storage<Scalar, m>;

    [[no_unique_address]] Extent<p> parameters_;
    [[no_unique_address]] Extent<m> outputs_;
    UdCovariance<Scalar, p, 1> learner_;
    Rows rows_; ///< of the pending sample
    Targets targets_;
    Targets variances_;
    Scalar noise_variance_ = 1;
    /// Next step: variances 0 … m - 1, then rows m … 2m - 1; 2m: no sample is pending.
    int next_;
};

} // namespace dfdyn
