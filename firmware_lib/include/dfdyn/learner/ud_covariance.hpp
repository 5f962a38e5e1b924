// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/forgetting.hpp"
#include "dfdyn/learner/ud_factor.hpp"

#include <algorithm>
#include <limits>

namespace dfdyn {

/// Recursive least squares of m outputs over the same p columns, by the factor P = U D U' of their covariance
/// (`UdFactor`): one sweep per row, after which the gain gives the weights of all outputs.
///
/// Learning can be sliced after the innovations, after any panel of the sweep, and before forgetting. Until
/// it is done, the weights and `variance` are those before the row.
///
/// After t rows, a row changes the weights by about 1/t of the change by the first row. In float this soon
/// falls below half a unit in the last place. The change would be lost, always where P is largest, and the
/// weights would drift. The sum is therefore compensated (`detail::add_compensated`): the rounding error is
/// added with the next row. Memory about p²/2 + (2m+3) p scalars.
template <class Scalar, int p, int m>
class UdCovariance {
  public:
    static constexpr int identity = 1;
    using Constants = LearnerConstants<Scalar, p, m>;

    /// `rows_of_instant`: rows per sample, passed to `begin_row` before forgetting is applied.
    UdCovariance(const Constants& constants, Extent<p> columns, Extent<m> outputs,
                 int rows_of_instant = 1) noexcept
        : factor_(columns),
          weights_(Weights::zeros(extent<product(m, padded(p))>(outputs * padded(columns)))), rest_(weights_),
          innovation_(Outputs::zeros(outputs)), columns_(columns), outputs_(outputs), constants_(&constants),
          forgetting_(constants.forgetting_factor, columns, rows_of_instant) {
        reset();
    }

    void reset() noexcept {
        factor_.reset(constants_->prior_variance);
        std::fill(weights_.begin(), weights_.end(), Scalar(0));
        std::fill(rest_.begin(), rest_.end(), Scalar(0));
        if (constants_->start != nullptr) {
            load(*constants_->start);
        }
        for (Scalar& value : innovation_) {
            value = 0;
        }
        forgetting_.restart();
        task_ = Task::none;
        noise_variance_ = 1;
        ratio_ = 1;
        information_ = 1;
        last_of_instant_ = 1;
    }

    void predict(const Scalar* row, Scalar* means) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            means[k] = detail::dot(weights(k), row, columns_);
        }
    }

    [[nodiscard]] Scalar variance(const Scalar* row) const noexcept { return factor_.variance(row); }

    [[nodiscard]] bool idle() const noexcept { return task_ == Task::none; }

    /// Returns true if the row of a sample has begun and is not learned yet.
    [[nodiscard]] bool sample_pending() const noexcept {
        return task_ == Task::innovation || task_ == Task::sample;
    }

    /// Begins to learn φ (p values) with m targets, each in units of its noise, measured with
    /// `noise_variance` in units of the noise variance. Only when idle.
    void begin(const Scalar* row, const Scalar* target, Scalar noise_variance = 1) noexcept {
        begin_row(row, target, noise_variance, true);
    }

    /// Same, for one of several rows of a sample: forgetting is applied once, after the last row.
    void begin_row(const Scalar* row, const Scalar* target, Scalar noise_variance,
                   bool last_of_instant) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            innovation_[k] = target[k]; // the prediction is subtracted later, within the budget
        }
        factor_.begin(row, noise_variance, forgetting_.resting());
        noise_variance_ = noise_variance;
        last_of_instant_ = last_of_instant ? 1 : 0;
        task_ = Task::innovation;
    }

    /// Begins to reset the covariance to the prior's; the weights stay. Only when idle.
    void reset_covariance() noexcept {
        factor_.begin_reset();
        task_ = Task::reset;
    }

    /// Continues the present task within the budget; returns true when nothing is left to do.
    bool advance(Budget& budget) noexcept {
        while (!idle()) {
            if (!work(budget)) {
                return false;
            }
        }
        return true;
    }

    /// Same, but leaves the work of forgetting to `advance`.
    bool learn(Budget& budget) noexcept {
        while (sample_pending()) {
            if (!work(budget)) {
                return false;
            }
        }
        return true;
    }

    /// Returns 1 + φ'Pφ / (noise variance) of the last learned row, before it was learned.
    [[nodiscard]] Scalar last_variance_ratio() const noexcept { return ratio_; }

    /// Returns the weights of one output, 0 ≤ output < m: p values in units of its noise.
    [[nodiscard]] const Scalar* weights(int output) const noexcept {
        return weights_.data() + output * padded(columns_);
    }

    /// Returns the variance P_ii of one parameter, 0 ≤ i < p. Only when idle. O(p).
    [[nodiscard]] Scalar parameter_variance(int i) const noexcept { return factor_.parameter_variance(i); }

    [[nodiscard]] const UdFactor<Scalar, p>& factor() const noexcept { return factor_; }

    [[nodiscard]] static constexpr Cost cost(int columns, int outputs) noexcept {
        const std::int64_t sweep = Factor::sweep_cost(columns);
        const std::int64_t predict = std::int64_t{columns} * outputs;
        const std::int64_t finish = finish_cost(columns, outputs);
        return {.predict = predict,
                .variance = Factor::variance_cost(columns) + Factor::sweeping_variance_cost(columns),
                .learn = predict + sweep + finish,
                .forget = forget_cost(columns) + sweep,
                .largest_step = std::max({Factor::largest_step(columns), finish, forget_cost(columns)}),
                .reset_covariance = Factor::reset_cost(columns)};
    }

    [[nodiscard]] static constexpr std::int64_t state_bytes(int columns, int outputs) noexcept {
        return Factor::state_bytes(columns) +
               2 * storage_bytes<Scalar>(std::int64_t{outputs} * padded(columns)) +
               storage_bytes<Scalar>(outputs);
    }

    /// Returns the maximum stack bytes over all calls.
    [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept {
        return frame_bytes + 32 * std::int64_t{sizeof(Scalar)};
    }

    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        Factor::visit_state(self.factor_, visitor);
        const int stride = self.weights_.size() / self.outputs_;
        for (int k = 0; k < self.outputs_; ++k) {
            visitor.array(self.weights_.data() + k * stride, self.columns_);
            visitor.array(self.rest_.data() + k * stride, self.columns_);
        }
        visitor.array(self.innovation_.data(), self.innovation_.size());
        visitor.positive_array(&self.noise_variance_, 1);
        visitor.positive_array(&self.ratio_, 1);
        visitor.positive_array(&self.information_, 1);
        visitor.ranged(self.last_of_instant_, 0, 1);
        visitor.ranged(self.task_, Task::none, Task::reset);
        Forgetting<Scalar>::visit_state(self.forgetting_, visitor);
    }

  private:
    using Factor = UdFactor<Scalar, p>;

    /// The next task. `sample` and `bound` are sweeps.
    enum class Task : int { none, innovation, sample, forget, bound, reset };

    static constexpr int padded(int columns) noexcept { return Factor::padded(columns); }
    static constexpr std::int64_t finish_cost(int columns, int outputs) noexcept {
        return std::int64_t{outputs} * (padded(columns) + 1) + 3;
    }
    static constexpr std::int64_t forget_cost(int columns) noexcept {
        return Forgetting<Scalar>::cost + 1 + Factor::scale_and_bound_cost(columns);
    }

    using Weights = Storage<Scalar, product(m, padded(p))>;
    using Outputs = Storage<Scalar, m>;

    void load(const LearnerStart<Scalar, p, m>& start) noexcept {
        factor_.load(start.unit_upper.data(), start.diagonal.data());
        for (int k = 0; k < outputs_; ++k) {
            for (int j = 0; j < columns_; ++j) {
                weights_[k * padded(columns_) + j] = start.weights[k * columns_ + j];
            }
        }
    }

    /// Performs the present task and selects the next one; returns false if the budget does not suffice.
    bool work(Budget& budget) noexcept {
        switch (task_) {
        case Task::innovation:
            return budget.spend(std::int64_t{columns_} * outputs_) && subtract_prediction();
        case Task::sample:
            return factor_.sweep(budget) && budget.spend(finish_cost(columns_, outputs_)) && finish();
        case Task::forget:
            return budget.spend(forget_cost(columns_)) && forget();
        case Task::reset:
            return factor_.reset(constants_->prior_variance, budget) && close();
        default:
            return factor_.sweep(budget) && close();
        }
    }

    bool subtract_prediction() noexcept {
        for (int k = 0; k < outputs_; ++k) {
            innovation_[k] -= detail::dot(weights(k), factor_.row(), columns_);
        }
        task_ = Task::sample;
        return true;
    }

    bool finish() noexcept {
        const Scalar share = 1 / factor_.alpha();
        for (int k = 0; k < outputs_; ++k) {
            const int first = k * padded(columns_);
            detail::add_compensated(innovation_[k] * share, factor_.gain(), weights_.data() + first,
                                    rest_.data() + first, padded(columns_));
        }
        ratio_ = factor_.alpha() / noise_variance_;
        information_ = std::min(information_ * ratio_, std::numeric_limits<Scalar>::max());
        close();
        if (last_of_instant_ != 0 && forgetting_.active()) {
            task_ = Task::forget;
        } else if (last_of_instant_ != 0) {
            information_ = 1;
        }
        return true;
    }

    bool forget() noexcept {
        factor_.scale(1 / forgetting_.factor_after(information_));
        information_ = 1;
        const bool bound = factor_.begin_bound(forgetting_.next_parameter(), constants_->prior_variance);
        task_ = bound ? Task::bound : Task::none;
        return true;
    }

    bool close() noexcept {
        factor_.close();
        task_ = Task::none;
        return true;
    }

    Factor factor_;
    Weights weights_;
    Weights rest_; ///< rounding errors of the weights
    Outputs innovation_;
    [[no_unique_address]] Extent<p> columns_;
    [[no_unique_address]] Extent<m> outputs_;
    const Constants* constants_;
    Forgetting<Scalar> forgetting_;
    Scalar noise_variance_ = 1;
    Scalar ratio_ = 1;
    Scalar information_ = 1; ///< product of the ratios of this sample's rows
    int last_of_instant_ = 1;
    Task task_ = Task::none;
};

} // namespace dfdyn
