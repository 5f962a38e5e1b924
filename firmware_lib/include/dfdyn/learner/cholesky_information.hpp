// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/forgetting.hpp"
#include "dfdyn/learner/kernels.hpp"
#include "dfdyn/learner/learner.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn {

/// Recursive least squares by the Cholesky factor of the information matrix, R'R = P⁻¹ (paper, Section IV-B).
/// Givens rotations fold each row into R and, with it, the targets into the right-hand sides z of R w = z.
/// This keeps full accuracy in single precision. The weights follow by back-substitution. For several outputs
/// that costs more than the update, so `UdCovariance` is the default. A row is folded in as a whole: a budget
/// below `cost().learn` learns nothing. Forgetting is a separate step, and so is bounding a variance.
///
/// R is stored by rows, from the diagonal on. Memory about p²/2 + (2m+2) p scalars.
template <class Scalar, int p, int m>
class CholeskyInformation {
  public:
    static constexpr int identity = 2;
    using Constants = LearnerConstants<Scalar, p, m>;

    CholeskyInformation(const Constants& constants, Extent<p> columns, Extent<m> outputs) noexcept
        : constants_(&constants), columns_(columns), outputs_(outputs),
          forgetting_(constants.forgetting_factor, columns),
          factor_(Factor::zeros(extent<factor_size(p)>(factor_size(columns)))),
          right_hand_sides_(PerOutput::zeros(extent<product(m, p)>(outputs * columns))),
          weights_(right_hand_sides_), row_(Columns::zeros(columns)), scratch_(Columns::zeros(columns)),
          target_(Outputs::zeros(outputs)) {
        reset();
    }

    void reset() noexcept {
        fill_prior();
        for (Scalar& z : right_hand_sides_) {
            z = 0;
        }
        if (constants_->start != nullptr) {
            load(*constants_->start);
        }
        solve_weights();
        for (Scalar& value : row_) {
            value = 0;
        }
        for (Scalar& value : target_) {
            value = 0;
        }
        forgetting_.restart();
        task_ = Task::none;
        noise_variance_ = 1;
        ratio_ = 1;
    }

    void predict(const Scalar* row, Scalar* means) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            means[k] = detail::dot(weights(k), row, columns_);
        }
    }

    /// Returns φ'Pφ = |R⁻ᵀφ|².
    [[nodiscard]] Scalar variance(const Scalar* row) const noexcept {
        for (int j = 0; j < columns_; ++j) {
            scratch_[j] = row[j];
        }
        return scratch_square(0);
    }

    [[nodiscard]] bool idle() const noexcept { return task_ == Task::none; }
    [[nodiscard]] bool sample_pending() const noexcept { return task_ == Task::sample; }

    /// `noise_variance`: of the targets, in units of their noise variance.
    void begin(const Scalar* row, const Scalar* target, Scalar noise_variance = 1) noexcept {
        for (int j = 0; j < columns_; ++j) {
            row_[j] = row[j];
        }
        for (int k = 0; k < outputs_; ++k) {
            target_[k] = target[k];
        }
        noise_variance_ = noise_variance;
        task_ = Task::sample;
    }

    /// Begins to reset the covariance to the prior's; the weights stay. Only when idle.
    void reset_covariance() noexcept { task_ = Task::reset; }

    bool advance(Budget& budget) noexcept {
        while (!idle()) {
            if (!work(budget)) {
                return false;
            }
        }
        return true;
    }

    [[nodiscard]] Scalar last_ratio() const noexcept { return ratio_; }

    [[nodiscard]] const Scalar* weights(int output) const noexcept {
        return weights_.data() + output * columns_;
    }

    [[nodiscard]] Scalar parameter_variance(int i) const noexcept {
        for (Scalar& value : scratch_) {
            value = 0;
        }
        scratch_[i] = 1;
        return scratch_square(i);
    }

    [[nodiscard]] static constexpr Cost cost(int columns, int outputs) noexcept {
        const std::int64_t learn =
            weigh_cost(columns, outputs) + variance_cost(columns) + fold_and_solve_cost(columns, outputs);
        const std::int64_t bound = outputs + fold_and_solve_cost(columns, outputs);
        const std::int64_t forget = forget_cost(columns, outputs);
        return {.predict = std::int64_t{columns} * outputs,
                .variance = variance_cost(columns),
                .learn = learn,
                .forget = forget + bound,
                .largest_step = std::max({learn, forget, bound}),
                .reset_covariance = reset_cost(columns, outputs)};
    }

    [[nodiscard]] static constexpr std::int64_t state_bytes(int columns, int outputs) noexcept {
        return storage_bytes<Scalar>(factor_size(columns)) +
               2 * storage_bytes<Scalar>(std::int64_t{outputs} * columns) +
               2 * storage_bytes<Scalar>(columns) + storage_bytes<Scalar>(outputs);
    }

    /// Maximum over all calls.
    [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept {
        return frame_bytes + 24 * std::int64_t{sizeof(Scalar)};
    }

    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        for (int i = 0; i < self.columns_; ++i) {
            visitor.positive_array(self.factor_row(i), 1);
            visitor.array(self.factor_row(i) + 1, self.columns_ - i - 1);
        }
        visitor.array(self.right_hand_sides_.data(), self.right_hand_sides_.size());
        visitor.array(self.weights_.data(), self.weights_.size());
        visitor.array(self.row_.data(), self.row_.size());
        visitor.array(self.target_.data(), self.target_.size());
        visitor.positive_array(&self.noise_variance_, 1);
        visitor.positive_array(&self.ratio_, 1);
        visitor.ranged(self.task_, Task::none, Task::reset);
        visitor.ranged(self.bounded_, 0, self.columns_ - 1);
        Forgetting<Scalar>::visit_state(self.forgetting_, visitor);
    }

  private:
    enum class Task : int { none, sample, forget, bound, reset };

    static constexpr std::int64_t half_square(int columns) noexcept {
        return std::int64_t{columns} * (columns + 1) / 2;
    }
    static constexpr std::int64_t variance_cost(int columns) noexcept {
        return half_square(columns) + columns;
    }
    /// Multiply-adds of the rotations of all columns, over the factor and the right-hand sides, and of the
    /// back-substitution.
    static constexpr std::int64_t fold_and_solve_cost(int columns, int outputs) noexcept {
        return std::int64_t{columns} * (function_cost + 2 + 4 * outputs) +
               (4 + outputs) * half_square(columns);
    }
    static constexpr std::int64_t weigh_cost(int columns, int outputs) noexcept {
        return function_cost + 1 + std::int64_t{columns} + outputs;
    }
    static constexpr std::int64_t reset_cost(int columns, int outputs) noexcept {
        return function_cost + 1 + half_square(columns) + std::int64_t{columns} * outputs;
    }
    static constexpr std::int64_t forget_cost(int columns, int outputs) noexcept {
        return Forgetting<Scalar>::cost + 2 * function_cost + 2 + half_square(columns) +
               std::int64_t{columns} * outputs + variance_cost(columns);
    }

    static constexpr int factor_size(int columns) noexcept {
        return columns == dynamic ? dynamic : columns * (columns + 1) / 2;
    }

    using Columns = Storage<Scalar, p>;
    using Factor = Storage<Scalar, factor_size(p)>;
    using PerOutput = Storage<Scalar, product(m, p)>;
    using Outputs = Storage<Scalar, m>;

    /// Returns row i of R from the diagonal on: columns_ - i entries.
    [[nodiscard]] Scalar* factor_row(int i) noexcept { return factor_.data() + row_offset(i); }
    [[nodiscard]] const Scalar* factor_row(int i) const noexcept { return factor_.data() + row_offset(i); }
    [[nodiscard]] int row_offset(int i) const noexcept { return i * columns_ - i * (i - 1) / 2; }

    [[nodiscard]] Scalar& right_hand_side(int k, int i) noexcept {
        return right_hand_sides_[k * columns_ + i];
    }

    /// Sets R = I / sqrt(prior variance).
    void fill_prior() noexcept {
        using std::sqrt;
        const Scalar diagonal = 1 / sqrt(constants_->prior_variance);
        for (int i = 0; i < columns_; ++i) {
            for (int j = i; j < columns_; ++j) {
                factor_row(i)[j - i] = i == j ? diagonal : Scalar(0);
            }
        }
    }

    /// Sets R = D^(-1/2) U⁻¹ and z = R w.
    void load(const LearnerStart<Scalar, p, m>& start) noexcept {
        for (int i = 0; i < columns_; ++i) {
            Scalar* row = factor_row(i);
            using std::sqrt;
            row[0] = 1 / sqrt(start.diagonal[i]);
            for (int j = i + 1; j < columns_; ++j) {
                const Scalar* column = start.unit_upper.data() + j * (j - 1) / 2;
                row[j - i] = -detail::dot(row, column + i, j - i);
            }
            for (int k = 0; k < outputs_; ++k) {
                right_hand_side(k, i) =
                    detail::dot(row, start.weights.data() + k * columns_ + i, columns_ - i);
            }
        }
    }

    /// Rotates the pending row, which is zero before column `first`, into R, and its targets into z.
    void fold(int first) noexcept {
        for (int i = first; i < columns_; ++i) {
            if (row_[i] == 0) {
                continue;
            }
            Scalar* factor = factor_row(i);
            using std::hypot;
            const Scalar length = hypot(factor[0], row_[i]);
            const Scalar cosine = factor[0] / length;
            const Scalar sine = row_[i] / length;
            rotate(cosine, sine, factor, row_.data() + i, columns_ - i);
            for (int k = 0; k < outputs_; ++k) {
                rotate(cosine, sine, &right_hand_side(k, i), &target_[k], 1);
            }
        }
    }

    static void rotate(Scalar cosine, Scalar sine, Scalar* __restrict upper, Scalar* __restrict lower,
                       int count) noexcept {
        for (int j = 0; j < count; ++j) {
            const Scalar old = upper[j];
            upper[j] = cosine * old + sine * lower[j];
            lower[j] = cosine * lower[j] - sine * old;
        }
    }

    void solve_weights() noexcept {
        for (int k = 0; k < outputs_; ++k) {
            Scalar* w = weights_.data() + k * columns_;
            for (int i = columns_ - 1; i >= 0; --i) {
                const Scalar* row = factor_row(i);
                const Scalar known = detail::dot(row + 1, w + i + 1, columns_ - i - 1);
                w[i] = (right_hand_side(k, i) - known) / row[0];
            }
        }
    }

    /// Returns |R⁻ᵀs|² of the scratch vector s, which is zero before `first`.
    [[nodiscard]] Scalar scratch_square(int first) const noexcept {
        Scalar total = 0;
        for (int i = first; i < columns_; ++i) {
            const Scalar* row = factor_row(i);
            const Scalar x = scratch_[i] / row[0];
            detail::add_scaled(-x, row + 1, scratch_.data() + i + 1, columns_ - i - 1);
            total += x * x;
        }
        return total;
    }

    /// Performs the present task and selects the next one; returns false if the budget does not suffice.
    bool work(Budget& budget) noexcept {
        switch (task_) {
        case Task::sample:
            return budget.spend(cost(columns_, outputs_).learn) && learn();
        case Task::forget:
            return budget.spend(forget_cost(columns_, outputs_)) && forget();
        case Task::reset:
            return budget.spend(reset_cost(columns_, outputs_)) && finish_reset();
        default:
            return budget.spend(outputs_ + fold_and_solve_cost(columns_, outputs_)) && bound_variance();
        }
    }

    bool learn() noexcept {
        weigh();
        ratio_ = 1 + variance(row_.data());
        fold(0);
        solve_weights();
        task_ = forgetting_.active() ? Task::forget : Task::none;
        return true;
    }

    /// Scales the pending row and targets to unit noise.
    void weigh() noexcept {
        using std::sqrt;
        const Scalar scale = 1 / sqrt(noise_variance_);
        for (Scalar& value : row_) {
            value *= scale;
        }
        for (Scalar& value : target_) {
            value *= scale;
        }
    }

    /// Sets R = I / sqrt(prior variance) and z = R w.
    bool finish_reset() noexcept {
        fill_prior();
        for (int k = 0; k < outputs_; ++k) {
            for (int i = 0; i < columns_; ++i) {
                right_hand_side(k, i) = factor_row(i)[0] * weights(k)[i];
            }
        }
        task_ = Task::none;
        return true;
    }

    /// Scales the information, which does not change the weights, and checks the variance of one parameter.
    bool forget() noexcept {
        using std::sqrt;
        const Scalar shrink = sqrt(forgetting_.factor_after(ratio_));
        for (Scalar& value : factor_) {
            value *= shrink;
        }
        for (Scalar& value : right_hand_sides_) {
            value *= shrink;
        }
        begin_bound(forgetting_.next_parameter());
        return true;
    }

    /// Begins to bound the variance of parameter i; see `UdFactor::begin_bound`.
    void begin_bound(int i) noexcept {
        using std::sqrt;
        const Scalar ceiling = constants_->prior_variance;
        const Scalar present = parameter_variance(i);
        task_ = present <= ceiling ? Task::none : Task::bound;
        if (task_ == Task::none) {
            return;
        }
        bounded_ = i;
        for (Scalar& value : row_) {
            value = 0;
        }
        row_[i] = sqrt(1 / ceiling - 1 / present);
    }

    bool bound_variance() noexcept {
        for (int k = 0; k < outputs_; ++k) {
            target_[k] = row_[bounded_] * weights(k)[bounded_];
        }
        fold(bounded_);
        solve_weights();
        task_ = Task::none;
        return true;
    }

    const Constants* constants_;
    [[no_unique_address]] Extent<p> columns_;
    [[no_unique_address]] Extent<m> outputs_;
    Forgetting<Scalar> forgetting_;
    Factor factor_;
    PerOutput right_hand_sides_; ///< m × p
    PerOutput weights_;          ///< m × p
    Columns row_;
    mutable Columns scratch_; ///< used by `variance`
    Outputs target_;
    Scalar noise_variance_ = 1; ///< of the pending sample
    Scalar ratio_ = 1;
    Task task_ = Task::none;
    int bounded_ = 0; ///< parameter whose variance is being bounded
};

} // namespace dfdyn
