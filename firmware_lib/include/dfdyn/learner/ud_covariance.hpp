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
/// Learning can be sliced after any panel of the sweep. Until it is done the weights and `variance` are the
/// old ones. Memory about p²/2 + (m+3) p.
template <class Scalar, int p, int m>
class UdCovariance {
  public:
    using Constants = LearnerConstants<Scalar, p, m>;

    /// `rows_of_instant`: that `begin_row` is given before it forgets.
    UdCovariance(const Constants& constants, Extent<p> columns, Extent<m> outputs,
                 int rows_of_instant = 1) noexcept
        : constants_(&constants), columns_(columns), outputs_(outputs),
          forgetting_(constants.forgetting_factor, columns, rows_of_instant), factor_(columns),
          weights_(Weights::zeros(extent<product(m, padded(p))>(outputs * padded(columns)))),
          innovation_(Outputs::zeros(outputs)) {
        reset();
    }

    void reset() noexcept {
        factor_.reset(constants_->prior_variance);
        for (Scalar& weight : weights_) {
            weight = 0;
        }
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

    /// Whether a sample's row is in hand and not yet learned.
    [[nodiscard]] bool sample_pending() const noexcept { return task_ == Task::sample; }

    /// Takes in φ (p values) and the m targets, each in units of its noise. Only when idle.
    void begin(const Scalar* row, const Scalar* target) noexcept { begin_row(row, target, 1, true); }

    /// The same with a noise of `noise_variance` times the unit, for one of several rows of the same instant:
    /// forgetting happens once, after the last.
    void begin_row(const Scalar* row, const Scalar* target, Scalar noise_variance,
                   bool last_of_instant) noexcept {
        predict(row, innovation_.data());
        for (int k = 0; k < outputs_; ++k) {
            innovation_[k] = target[k] - innovation_[k];
        }
        factor_.begin(row, noise_variance);
        noise_variance_ = noise_variance;
        last_of_instant_ = last_of_instant ? 1 : 0;
        task_ = Task::sample;
    }

    /// Works on the row in hand as far as the budget goes; true when there is none left.
    bool advance(Budget& budget) noexcept {
        while (!idle()) {
            if (!factor_.sweep(budget) || !budget.spend(finish_cost(columns_, outputs_))) {
                return false;
            }
            finish();
        }
        return true;
    }

    /// 1 + φ'Pφ / (noise variance) of the last row learned, before it was learned.
    [[nodiscard]] Scalar last_ratio() const noexcept { return ratio_; }

    /// Weights of one output, p values in units of its noise.
    [[nodiscard]] const Scalar* weights(int output) const noexcept {
        return weights_.data() + output * padded(columns_);
    }

    /// Variance of one parameter, P_ii, while idle. O(p).
    [[nodiscard]] Scalar parameter_variance(int i) const noexcept { return factor_.parameter_variance(i); }

    [[nodiscard]] const UdFactor<Scalar, p>& factor() const noexcept { return factor_; }

    [[nodiscard]] static constexpr Cost cost(int columns, int outputs) noexcept {
        using Factor = UdFactor<Scalar, p>;
        const std::int64_t finish = finish_cost(columns, outputs);
        return {std::int64_t{columns} * outputs, Factor::variance_cost(columns),
                Factor::sweep_cost(columns) + finish, std::max(Factor::largest_step(columns), finish)};
    }

    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        UdFactor<Scalar, p>::visit_state(self.factor_, visitor);
        visitor.array(self.weights_.data(), self.weights_.size());
        visitor.array(self.innovation_.data(), self.innovation_.size());
        visitor.positive_array(&self.noise_variance_, 1);
        visitor.positive_array(&self.ratio_, 1);
        visitor.positive_array(&self.information_, 1);
        visitor.ranged(self.last_of_instant_, 0, 1);
        visitor.ranged(self.task_, Task::none, Task::bound);
        Forgetting<Scalar>::visit_state(self.forgetting_, visitor);
    }

  private:
    /// What the sweep under way does.
    enum class Task : int { none, sample, bound };

    static constexpr int padded(int columns) noexcept { return UdFactor<Scalar, p>::padded(columns); }
    static constexpr std::int64_t finish_cost(int columns, int outputs) noexcept {
        return std::int64_t{columns} * (outputs + 2);
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

    void finish() noexcept {
        const bool bound = task_ == Task::bound;
        factor_.close();
        task_ = Task::none;
        if (bound) {
            return; // a variance was taken back; the weights stay
        }
        for (int k = 0; k < outputs_; ++k) {
            detail::add_scaled(innovation_[k] / factor_.alpha(), factor_.gain(),
                               weights_.data() + k * padded(columns_), columns_);
        }
        ratio_ = factor_.alpha() / noise_variance_;
        if (forgetting_.active()) {
            information_ = std::min(information_ * ratio_, std::numeric_limits<Scalar>::max());
        }
        if (last_of_instant_ != 0) {
            forget();
            information_ = 1;
        }
    }

    void forget() noexcept {
        if (!forgetting_.active()) {
            return;
        }
        factor_.scale(1 / forgetting_.factor_after(information_));
        if (factor_.begin_bound(forgetting_.next_parameter(), constants_->prior_variance)) {
            task_ = Task::bound;
        }
    }

    const Constants* constants_;
    [[no_unique_address]] Extent<p> columns_;
    [[no_unique_address]] Extent<m> outputs_;
    Forgetting<Scalar> forgetting_;
    UdFactor<Scalar, p> factor_;
    Weights weights_;
    Outputs innovation_;
    Scalar noise_variance_ = 1;
    Scalar ratio_ = 1;
    Scalar information_ = 1; ///< product of the ratios of this instant's rows
    int last_of_instant_ = 1;
    Task task_ = Task::none;
};

} // namespace dfdyn
