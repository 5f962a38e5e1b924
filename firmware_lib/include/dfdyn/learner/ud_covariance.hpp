// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/forgetting.hpp"
#include "dfdyn/learner/kernels.hpp"
#include "dfdyn/learner/learner.hpp"

namespace dfdyn {

/// Recursive least squares by the square-root-free Cholesky factor of the covariance, P = U D U' (G. J.
/// Bierman, "Factorization Methods for Discrete Sequential Estimation", 1977). One sweep over the columns per
/// row: 1.5 p² multiply-adds, no square root, and the gain, the weights of all m outputs and the predictive
/// variance come with it.
///
/// U is stored in panels of four columns: panel b holds rows 0 … 4b-1 of columns 4b … 4b+3, column after
/// column, then come the six entries of its triangular block. Columns beyond p pad the last panel with zeros.
/// Memory about p²/2 + (m+4) p.
///
/// A sweep can stop after any panel and go on later. Until it is done the weights are the old ones, and
/// `variance` is that of the old covariance too, exactly: after j columns the part of P already updated is
/// that of a rank-one downdate, Σ_{i≤j} ū d̄ ū' = Σ_{i≤j} u d u' - g g'/α, with the partial gain g and α that
/// the sweep carries.
template <class Scalar, int p, int m>
class UdCovariance {
  public:
    using Constants = LearnerConstants<Scalar, p, m>;

    UdCovariance(const Constants& constants, Extent<p> columns, Extent<m> outputs) noexcept
        : constants_(&constants), columns_(columns), outputs_(outputs),
          forgetting_(constants.forgetting_factor, columns),
          panels_(Panels::zeros(extent<panels_size(p)>(panels_size(columns)))),
          triangles_(Triangles::zeros(extent<triangles_size(p)>(triangles_size(columns)))),
          diagonal_(zero_columns()),
          weights_(Weights::zeros(extent<product(m, padded(p))>(outputs * padded(columns)))),
          row_(zero_columns()), gain_(zero_columns()), innovation_(Outputs::zeros(outputs)) {
        reset();
    }

    void reset() noexcept {
        clear(panels_);
        clear(triangles_);
        clear(weights_);
        for (Scalar& d : diagonal_) {
            d = constants_->prior_variance;
        }
        if (constants_->start != nullptr) {
            load(*constants_->start);
        }
        clear(row_);
        clear(gain_);
        clear(innovation_);
        forgetting_.restart();
        alpha_ = 1;
        panel_ = 0;
        task_ = Task::none;
        ratio_ = 1;
    }

    void predict(const Scalar* row, Scalar* means) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            means[k] = detail::dot(weights(k), row, columns_);
        }
    }

    [[nodiscard]] Scalar variance(const Scalar* row) const noexcept {
        Scalar total = 0;
        for (int b = 0; b < panel_count(); ++b) {
            Scalar f[detail::panel_width];
            project(b, row, f);
            for (int c = 0; c < detail::panel_width; ++c) {
                total += f[c] * f[c] * diagonal_[detail::panel_width * b + c];
            }
        }
        if (!idle()) {
            const int done = smaller(detail::panel_width * panel_, columns_);
            const Scalar taken = detail::dot(gain_.data(), row, done);
            total += taken * taken / alpha_;
        }
        return total;
    }

    [[nodiscard]] bool idle() const noexcept { return task_ == Task::none; }

    /// Whether a sample's row is in hand and not yet learned.
    [[nodiscard]] bool sample_pending() const noexcept { return task_ == Task::sample; }

    /// Takes in φ (p values) and the m targets, each in units of its noise. Only when idle.
    void begin(const Scalar* row, const Scalar* target) noexcept {
        predict(row, innovation_.data());
        for (int k = 0; k < outputs_; ++k) {
            innovation_[k] = target[k] - innovation_[k];
        }
        for (int j = 0; j < columns_; ++j) {
            row_[j] = row[j];
        }
        alpha_ = 1;
        panel_ = 0;
        task_ = Task::sample;
    }

    /// Works on the row in hand as far as the budget goes; true when there is none left.
    bool advance(Budget& budget) noexcept {
        while (!idle()) {
            if (panel_ < panel_count()) {
                if (!budget.spend(panel_cost(panel_))) {
                    return false;
                }
                fold_panel(panel_);
                ++panel_;
            } else {
                if (!budget.spend(finish_cost(columns_, outputs_))) {
                    return false;
                }
                finish();
            }
        }
        return true;
    }

    /// 1 + φ'Pφ of the last row learned, before it was learned.
    [[nodiscard]] Scalar last_ratio() const noexcept { return ratio_; }

    /// Weights of one output, p values in units of its noise.
    [[nodiscard]] const Scalar* weights(int output) const noexcept {
        return weights_.data() + output * padded(columns_);
    }

    /// Variance of one parameter, P_ii, while idle. O(p).
    [[nodiscard]] Scalar parameter_variance(int i) const noexcept {
        Scalar total = diagonal_[i];
        for (int j = i + 1; j < columns_; ++j) {
            total += upper(i, j) * upper(i, j) * diagonal_[j];
        }
        return total;
    }

    /// Element of U above the diagonal, i < j.
    [[nodiscard]] Scalar upper(int i, int j) const noexcept { return upper_element(*this, i, j); }

    [[nodiscard]] Scalar diagonal(int j) const noexcept { return diagonal_[j]; }

    [[nodiscard]] static constexpr Cost cost(int columns, int outputs) noexcept {
        const int last = padded(columns) / detail::panel_width - 1;
        Cost cost{std::int64_t{columns} * outputs, 0, finish_cost(columns, outputs), 0};
        for (int b = 0; b <= last; ++b) {
            cost.variance += panel_cost(b) / 3;
            cost.learn += panel_cost(b);
        }
        const std::int64_t finish = finish_cost(columns, outputs);
        cost.largest_step = panel_cost(last) > finish ? panel_cost(last) : finish;
        return cost;
    }

    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        visitor.array(self.panels_.data(), self.panels_.size());
        visitor.array(self.triangles_.data(), self.triangles_.size());
        visitor.positive_array(self.diagonal_.data(), self.diagonal_.size());
        visitor.array(self.weights_.data(), self.weights_.size());
        visitor.array(self.row_.data(), self.row_.size());
        visitor.array(self.gain_.data(), self.gain_.size());
        visitor.array(self.innovation_.data(), self.innovation_.size());
        visitor.positive_array(&self.alpha_, 1);
        visitor.positive_array(&self.ratio_, 1);
        visitor.ranged(self.panel_, 0, self.panel_count());
        visitor.ranged(self.task_, Task::none, Task::bound);
        Forgetting<Scalar>::visit_state(self.forgetting_, visitor);
    }

  private:
    /// What the sweep under way does.
    enum class Task : int { none, sample, bound };

    static constexpr int padded(int columns) noexcept {
        constexpr int width = detail::panel_width;
        return columns == dynamic ? dynamic : (columns + width - 1) / width * width;
    }
    static constexpr int panels_size(int columns) noexcept {
        if (columns == dynamic) {
            return dynamic;
        }
        const int panels = padded(columns) / detail::panel_width;
        return panels > 1 ? 8 * panels * (panels - 1) : 1;
    }
    static constexpr int triangles_size(int columns) noexcept {
        return columns == dynamic ? dynamic : 6 * (padded(columns) / detail::panel_width);
    }
    static constexpr int smaller(int a, int b) noexcept { return a < b ? a : b; }

    using Columns = Storage<Scalar, padded(p)>;
    using Panels = Storage<Scalar, panels_size(p)>;
    using Triangles = Storage<Scalar, triangles_size(p)>;
    using Weights = Storage<Scalar, product(m, padded(p))>;
    using Outputs = Storage<Scalar, m>;

    [[nodiscard]] Columns zero_columns() const noexcept {
        return Columns::zeros(extent<padded(p)>(padded(columns_)));
    }

    template <class Array>
    static void clear(Array& array) noexcept {
        for (Scalar& value : array) {
            value = 0;
        }
    }

    [[nodiscard]] int panel_count() const noexcept { return padded(columns_) / detail::panel_width; }
    static constexpr int panel_offset(int b) noexcept { return 8 * b * (b - 1); }
    /// Index of entry (r, c), r < c, of a panel's triangular block.
    static constexpr int triangle_index(int b, int r, int c) noexcept { return 6 * b + c * (c - 1) / 2 + r; }

    template <class Self>
    static auto& upper_element(Self& self, int i, int j) noexcept {
        const int b = j / detail::panel_width;
        const int first = detail::panel_width * b;
        return i < first ? self.panels_[panel_offset(b) + (j - first) * first + i]
                         : self.triangles_[triangle_index(b, i - first, j - first)];
    }

    static constexpr std::int64_t panel_cost(int b) noexcept { return std::int64_t{48} * b + 48; }
    static constexpr std::int64_t finish_cost(int columns, int outputs) noexcept {
        return std::int64_t{columns} * (outputs + 2);
    }

    void load(const LearnerStart<Scalar, p, m>& start) noexcept {
        for (int j = 0; j < columns_; ++j) {
            diagonal_[j] = start.diagonal[j];
            const Scalar* column = start.unit_upper.data() + j * (j - 1) / 2;
            for (int i = 0; i < j; ++i) {
                upper_element(*this, i, j) = column[i];
            }
            for (int k = 0; k < outputs_; ++k) {
                weights_[k * padded(columns_) + j] = start.weights[k * columns_ + j];
            }
        }
    }

    /// f = U'φ for the four columns of panel b.
    void project(int b, const Scalar* row, Scalar (&f)[detail::panel_width]) const noexcept {
        const int first = detail::panel_width * b;
        detail::panel_dots(panels_.data() + panel_offset(b), row, first, f);
        for (int c = 0; c < detail::panel_width && first + c < columns_; ++c) {
            for (int r = 0; r < c; ++r) {
                f[c] += triangles_[triangle_index(b, r, c)] * row[first + r];
            }
            f[c] += row[first + c];
        }
    }

    void fold_panel(int b) noexcept {
        Scalar f[detail::panel_width];
        project(b, row_.data(), f);
        Scalar v[detail::panel_width];
        Scalar mu[detail::panel_width];
        const int first = detail::panel_width * b;
        for (int c = 0; c < detail::panel_width; ++c) {
            Scalar& d = diagonal_[first + c];
            v[c] = d * f[c];
            mu[c] = -f[c] / alpha_;
            const Scalar next = alpha_ + f[c] * v[c];
            d *= alpha_ / next;
            alpha_ = next;
        }
        detail::panel_update(panels_.data() + panel_offset(b), gain_.data(), first, v, mu);
        fold_triangle(b, v, mu);
    }

    void fold_triangle(int b, const Scalar (&v)[detail::panel_width],
                       const Scalar (&mu)[detail::panel_width]) noexcept {
        for (int r = 0; r < detail::panel_width; ++r) {
            Scalar gain = v[r];
            for (int c = r + 1; c < detail::panel_width; ++c) {
                Scalar& u = triangles_[triangle_index(b, r, c)];
                const Scalar old = u;
                u += mu[c] * gain;
                gain += v[c] * old;
            }
            gain_[detail::panel_width * b + r] = gain;
        }
    }

    void finish() noexcept {
        if (task_ == Task::bound) {
            task_ = Task::none; // a variance was taken back; the weights stay
            return;
        }
        task_ = Task::none;
        for (int k = 0; k < outputs_; ++k) {
            detail::add_scaled(innovation_[k] / alpha_, gain_.data(), weights_.data() + k * padded(columns_),
                               columns_);
        }
        ratio_ = alpha_;
        if (forgetting_.active()) {
            forget();
        }
    }

    void forget() noexcept {
        const Scalar growth = 1 / forgetting_.factor_after(ratio_);
        for (int j = 0; j < columns_; ++j) {
            diagonal_[j] *= growth;
        }
        bound_variance(forgetting_.next_parameter());
    }

    /// If P_ii has outgrown the prior's, begins a pseudo-measurement of parameter i alone, at its present
    /// value and as precise as it takes to bring the variance back.
    void bound_variance(int i) noexcept {
        const Scalar ceiling = constants_->prior_variance;
        const Scalar present = parameter_variance(i);
        if (present <= ceiling) {
            return;
        }
        clear(row_);
        clear(gain_);
        row_[i] = 1;
        alpha_ = ceiling * (present / (present - ceiling));
        panel_ = i / detail::panel_width;
        task_ = Task::bound;
    }

    const Constants* constants_;
    [[no_unique_address]] Extent<p> columns_;
    [[no_unique_address]] Extent<m> outputs_;
    Forgetting<Scalar> forgetting_;
    Panels panels_;
    Triangles triangles_;
    Columns diagonal_;
    Weights weights_;
    Columns row_;
    Columns gain_;
    Outputs innovation_;
    Scalar alpha_ = 1; ///< the row's noise variance (1 for a sample) + φ'Pφ over the columns done
    Scalar ratio_ = 1;
    int panel_ = 0; ///< next panel to fold
    Task task_ = Task::none;
};

} // namespace dfdyn
