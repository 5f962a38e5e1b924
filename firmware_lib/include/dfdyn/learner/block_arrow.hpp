// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/block_arrow_parts.hpp"

#include <algorithm>

namespace dfdyn {

/// Recursive least squares of model SPK: y_k = φ'w_k + ψ_k'π + e_k, with the same columns φ but separate
/// weights for each of the m outputs, and p parameters π common to all outputs (paper, Section IV-A).
///
/// Its information matrix is a block arrow: m equal blocks for the w_k, coupled only through π. Eliminating
/// the blocks (Schur complement) leaves two small problems, without approximation:
///  - y_k and every column of ψ_k are regressed on φ, with one factor for all, as m (1+p) outputs of model
///    NP. The residuals are ẽ_k = y_k - φ'a_k and ψ̃_k = ψ_k - G_k'φ; their noise has the variance α = 1 +
///    φ'Pφ.
///  - ẽ_k = ψ̃_k'π + noise of variance α, the problem of `CommonParameters`.
///
/// Then E[w_k] = a_k - G_k π. A row costs 1.5 (2d)² + 2·2d·m(1+p) + 1.5 m p² multiply-adds instead of 1.5
/// (m·2d + p)²; memory (2d)²/2 + 2d·m(1+p) + p²/2 scalars.
///
/// With forgetting this holds while both parts apply the same λ. Each part has its own account (see
/// `Forgetting`), and the bound of the variances applies to w given π.
///
/// Learning can be sliced after any panel of the sweep and after any column of weights. Predictions and
/// variances are those before the sample until its rows are learned by π, and those after it from then on.
template <class Scalar, int columns, int p, int m>
class BlockArrow : public BlockArrowFootprint<Scalar, columns, p, m> {
  public:
    static constexpr int identity = 3;
    using Constants = BlockArrowConstants<Scalar, columns, p, m>;

    BlockArrow(const Constants& constants, Extent<columns> column_count, Extent<p> parameters,
               Extent<m> outputs) noexcept
        : constants_(&constants), columns_(column_count), parameters_(parameters), outputs_(outputs),
          forgetting_(constants.features.forgetting_factor, column_count), factor_(column_count),
          common_(constants.common, parameters, outputs),
          weights_(Weights::zeros(
              extent<product(regressions, padded(columns))>(regression_count() * padded(columns_)))),
          present_(Residual::zeros(parameters_, outputs_)), in_hand_(present_) {
        reset();
    }

    void reset() noexcept {
        factor_.reset(constants_->features.prior_variance);
        for (Scalar& weight : weights_) {
            weight = 0;
        }
        if (constants_->features.start != nullptr) {
            load(*constants_->features.start);
        }
        common_.reset();
        forgetting_.restart();
        present_.clear();
        in_hand_.clear();
        alpha_ = 1;
        noise_variance_ = 1;
        task_ = Task::none;
        next_ = 0;
        fresh_ = false;
    }

    /// Computes the m means for φ (2d values) and the rows ψ (m × p, row-major), which become the present
    /// columns of `variances` and `begin`. O(2d m (1+p)).
    void predict(const Scalar* phi, const Scalar* psi, Scalar* means) noexcept {
        const Scalar pending =
            task_ == Task::weights ? detail::dot(factor_.gain(), phi, columns_) / alpha_ : Scalar(0);
        for (int k = 0; k < outputs_; ++k) {
            const int first = k * (1 + parameters_);
            present_.output[k] = projection(first, phi, pending);
            Scalar* row = present_.rows.data() + k * parameters_;
            for (int c = 0; c < parameters_; ++c) {
                row[c] = psi[k * parameters_ + c] - projection(first + 1 + c, phi, pending);
            }
        }
        common_.predict(present_.rows.data(), means);
        for (int k = 0; k < outputs_; ++k) {
            means[k] += present_.output[k];
        }
        fresh_ = true;
    }

    /// Computes the m variances of the predicted means at the present columns, whose features are `phi`.
    /// Returns the features' part, φ'Pφ. O((2d)² + m p²).
    Scalar variances(const Scalar* phi, Scalar* variances) const noexcept {
        common_.variances(present_.rows.data(), variances);
        const Scalar shared = factor_.variance(phi);
        for (int k = 0; k < outputs_; ++k) {
            variances[k] += shared;
        }
        return shared;
    }

    [[nodiscard]] bool idle() const noexcept { return task_ == Task::none; }
    [[nodiscard]] bool sample_pending() const noexcept { return !idle() && task_ < Task::forget; }

    /// Begins to learn the present columns (those of the last `predict`) with the m targets, measured with
    /// `noise_variance` in units of their noise variance. Only when idle. If weights were updated since
    /// `predict`, the residual of the columns is computed again, within the budget.
    void begin(const Scalar* phi, const Scalar* psi, const Scalar* targets,
               Scalar noise_variance = 1) noexcept {
        for (int k = 0; k < outputs_; ++k) {
            in_hand_.output[k] = fresh_ ? targets[k] - present_.output[k] : targets[k];
        }
        for (int element = 0; element < outputs_ * parameters_; ++element) {
            in_hand_.rows[element] = fresh_ ? present_.rows[element] : psi[element];
        }
        factor_.begin(phi, noise_variance, forgetting_.resting());
        noise_variance_ = noise_variance;
        next_ = 0;
        task_ = fresh_ ? Task::sweep : Task::residual;
        fresh_ = false;
    }

    /// Begins to reset the covariance to the prior's, in which w and π are independent. Predictions do not
    /// change. Only when idle.
    void reset_covariance() noexcept {
        factor_.begin_reset();
        next_ = 0;
        fresh_ = false;
        task_ = Task::reset_factor;
    }

    /// Continues the present task within the budget; returns true when nothing is left to do.
    bool advance(Budget& budget) noexcept {
        while (!idle()) {
            if (!work(budget)) {
                return false;
            }
            go_on();
        }
        return true;
    }

    /// Writes 1 + the variance of each output's mean at the last learned sample, before it was learned;
    /// returns φ'Pφ of that time.
    Scalar last_variance_ratios(Scalar* ratios) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            ratios[k] = alpha_ + (1 - noise_variance_) + common_.last_variances()[k];
        }
        return alpha_ - 1;
    }

    /// Returns the factor of P, which all outputs share.
    [[nodiscard]] const UdFactor<Scalar, columns>& factor() const noexcept { return factor_; }
    [[nodiscard]] const CommonParameters<Scalar, p, m>& common() const noexcept { return common_; }

    /// Copies E[w_k] of all outputs, m × 2d. O(2d m p).
    void copy_weights(Scalar* result) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            Scalar* w = result + k * columns_;
            for (int j = 0; j < columns_; ++j) {
                w[j] = weights(k, 0)[j];
            }
            for (int c = 0; c < parameters_; ++c) {
                detail::add_scaled(-common_.parameters()[c], weights(k, 1 + c), w, columns_);
            }
        }
    }

    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        Factor::visit_state(self.factor_, visitor);
        CommonParameters<Scalar, p, m>::visit_state(self.common_, visitor);
        const int stride = self.weights_.size() / self.regression_count();
        for (int i = 0; i < self.regression_count(); ++i) {
            visitor.array(self.weights_.data() + i * stride, self.columns_);
        }
        visitor.array(self.in_hand_.rows.data(), self.in_hand_.rows.size());
        visitor.array(self.in_hand_.output.data(), self.in_hand_.output.size());
        visitor.positive_array(&self.alpha_, 1);
        visitor.positive_array(&self.noise_variance_, 1);
        visitor.ranged(self.next_, 0, self.regression_count());
        visitor.ranged(self.task_, Task::none, Task::reset_parameters);
        Forgetting<Scalar>::visit_state(self.forgetting_, visitor);
    }

  private:
    using Task = ArrowTask;
    using Residual = ArrowResidual<Scalar, p, m>;

    static constexpr int regressions = product(m, sum(p, 1));

    using Base = BlockArrowFootprint<Scalar, columns, p, m>;
    using Base::forget_cost;
    using Base::weights_cost;
    using Factor = UdFactor<Scalar, columns>;
    using Weights = Storage<Scalar, product(regressions, Factor::padded(columns))>;

    static constexpr int padded(int count) noexcept { return Factor::padded(count); }
    [[nodiscard]] int regression_count() const noexcept { return outputs_ * (1 + parameters_); }

    /// Returns the weights of column c of output k: a_k for c = 0, those of G_k for c = 1 … p.
    [[nodiscard]] const Scalar* weights(int k, int c) const noexcept {
        return weights_.data() + (k * (1 + parameters_) + c) * padded(columns_);
    }

    /// Returns φ times the weights of regression i, as they will be after an update in progress; `pending` =
    /// φ'K/α.
    [[nodiscard]] Scalar projection(int i, const Scalar* phi, Scalar pending) const noexcept {
        const Scalar now = detail::dot(weights_.data() + i * padded(columns_), phi, columns_);
        return task_ != Task::weights || i < next_ ? now : now + pending * residual(*this, i);
    }

    void load(const LearnerStart<Scalar, columns, regressions>& start) noexcept {
        factor_.load(start.unit_upper.data(), start.diagonal.data());
        for (int i = 0; i < regression_count(); ++i) {
            for (int j = 0; j < columns_; ++j) {
                weights_[i * padded(columns_) + j] = start.weights[i * columns_ + j];
            }
        }
    }

    /// Performs the present task within the budget; returns true when it is done.
    bool work(Budget& budget) noexcept {
        switch (task_) {
        case Task::residual:
            return subtract_features(budget);
        case Task::common:
            return common_.learn(budget);
        case Task::weights:
            return update_weights(budget);
        case Task::forget:
            return common_.advance(budget) && (!forgetting_.active() || budget.spend(forget_cost(columns_)));
        case Task::reset_factor:
            return factor_.reset(constants_->features.prior_variance, budget);
        case Task::reset_coupling:
            return decouple(budget);
        case Task::reset_parameters:
            return common_.advance(budget);
        default:
            return factor_.sweep(budget);
        }
    }

    /// Selects the task that follows a completed one.
    void go_on() noexcept {
        switch (task_) {
        case Task::residual:
            task_ = Task::sweep;
            break;
        case Task::sweep:
            alpha_ = factor_.alpha();
            common_.begin(in_hand_.rows.data(), in_hand_.output.data(), alpha_);
            task_ = Task::common;
            break;
        case Task::common:
            factor_.close();
            next_ = 0;
            task_ = Task::weights;
            break;
        case Task::weights:
            task_ = forgetting_.active() || !common_.idle() ? Task::forget : Task::none;
            break;
        case Task::forget:
            task_ = forget() ? Task::bound : Task::none;
            break;
        case Task::reset_factor:
            task_ = Task::reset_coupling;
            break;
        case Task::reset_coupling:
            common_.reset_covariance();
            task_ = Task::reset_parameters;
            break;
        default:
            factor_.close();
            task_ = Task::none;
        }
    }

    /// Returns the pending residual of regression i.
    template <class Self>
    [[nodiscard]] static auto& residual(Self& self, int i) noexcept {
        const int k = i / (1 + self.parameters_);
        const int c = i % (1 + self.parameters_);
        return c == 0 ? self.in_hand_.output[k] : self.in_hand_.rows[k * self.parameters_ + c - 1];
    }

    bool subtract_features(Budget& budget) noexcept {
        for (; next_ < regression_count(); ++next_) {
            if (!budget.spend(columns_)) {
                return false;
            }
            residual(*this, next_) -=
                detail::dot(weights_.data() + next_ * padded(columns_), factor_.row(), columns_);
        }
        return true;
    }

    bool update_weights(Budget& budget) noexcept {
        for (; next_ < regression_count(); ++next_) {
            if (!budget.spend(weights_cost(columns_))) {
                return false;
            }
            detail::add_scaled(residual(*this, next_) / alpha_, factor_.gain(),
                               weights_.data() + next_ * padded(columns_), columns_);
            fresh_ = false;
        }
        return true;
    }

    /// Sets G_k = 0 and a_k = E[w_k], column by column, which leaves the predictions unchanged.
    bool decouple(Budget& budget) noexcept {
        for (; next_ < regression_count(); ++next_) {
            const int k = next_ / (1 + parameters_);
            const int c = next_ % (1 + parameters_);
            if (c == 0) {
                continue;
            }
            if (!budget.spend(weights_cost(columns_))) {
                return false;
            }
            Scalar* const coupling = weights_.data() + next_ * padded(columns_);
            detail::add_scaled(-common_.parameters()[c - 1], coupling,
                               weights_.data() + k * (1 + parameters_) * padded(columns_), columns_);
            std::fill_n(coupling, int{columns_}, Scalar(0));
            fresh_ = false; // a sample predicted meanwhile had the weights before
        }
        return true;
    }

    /// Applies forgetting; returns true if a variance must be bounded.
    bool forget() noexcept {
        if (!forgetting_.active()) {
            return false;
        }
        factor_.scale(1 / forgetting_.factor_after(alpha_ / noise_variance_));
        return factor_.begin_bound(forgetting_.next_parameter(), constants_->features.prior_variance);
    }

    const Constants* constants_;
    [[no_unique_address]] Extent<columns> columns_;
    [[no_unique_address]] Extent<p> parameters_;
    [[no_unique_address]] Extent<m> outputs_;
    Forgetting<Scalar> forgetting_;
    Factor factor_;
    CommonParameters<Scalar, p, m> common_;
    Weights weights_; ///< m (1+p) × padded 2d
    Residual present_;
    Residual in_hand_;
    Scalar alpha_ = 1; ///< noise variance + φ'Pφ of the pending sample, once its sweep is done
    Scalar noise_variance_ = 1;
    int next_ = 0;       ///< next column of weights
    bool fresh_ = false; ///< the present residual belongs to the present weights
    Task task_ = Task::none;
};

} // namespace dfdyn
