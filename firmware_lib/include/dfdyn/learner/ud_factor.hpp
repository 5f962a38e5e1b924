// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/kernels.hpp"
#include "dfdyn/learner/learner.hpp"

#include <algorithm>

namespace dfdyn {

/// The covariance P = U D U' of p parameters as its square-root-free Cholesky factor, and the sweep that
/// folds a row into it (G. J. Bierman, "Factorization Methods for Discrete Sequential Estimation", 1977): 1.5
/// p² multiply-adds, no square root, and the gain and the predictive variance come with it.
///
/// U is stored in panels of four columns: panel b holds rows 0 … 4b-1 of columns 4b … 4b+3, column after
/// column, then come the six entries of its triangular block. Columns beyond p pad the last panel with zeros.
/// Memory about p²/2 + 3 p.
///
/// A sweep can stop after any panel and go on later. Until it is closed `variance` is that of the old
/// covariance, exactly: after j columns the part of P already updated is that of a rank-one downdate,
/// Σ_{i≤j} ū d̄ ū' = Σ_{i≤j} u d u' - g g'/α, with the partial gain g and α that the sweep carries.
template <class Scalar, int p>
class UdFactor {
  public:
    static constexpr int padded(int columns) noexcept {
        constexpr int width = detail::panel_width;
        return columns == dynamic ? dynamic : (columns + width - 1) / width * width;
    }

    /// A row or a gain, padded with zeros to whole panels.
    using Columns = Storage<Scalar, padded(p)>;

    explicit UdFactor(Extent<p> columns) noexcept
        : columns_(columns), panels_(Panels::zeros(extent<panels_size(p)>(panels_size(columns)))),
          triangles_(Triangles::zeros(extent<triangles_size(p)>(triangles_size(columns)))),
          diagonal_(zero_columns()), row_(zero_columns()), gain_(zero_columns()) {}

    /// P = `variance` I; forgets a sweep under way.
    void reset(Scalar variance) noexcept {
        clear(panels_);
        clear(triangles_);
        for (Scalar& d : diagonal_) {
            d = variance;
        }
        clear(row_);
        clear(gain_);
        alpha_ = 1;
        panel_ = 0;
        sweeping_ = 0;
    }

    /// The factor of a start: U above its diagonal by columns, and D.
    void load(const Scalar* unit_upper, const Scalar* diagonal) noexcept {
        for (int j = 0; j < columns_; ++j) {
            diagonal_[j] = diagonal[j];
            const Scalar* column = unit_upper + j * (j - 1) / 2;
            for (int i = 0; i < j; ++i) {
                upper_element(*this, i, j) = column[i];
            }
        }
    }

    /// h'Ph of a row h of p values, under a sweep that of the covariance before it. O(p²).
    [[nodiscard]] Scalar variance(const Scalar* row) const noexcept {
        Scalar total = 0;
        for (int b = 0; b < panel_count(); ++b) {
            Scalar f[detail::panel_width];
            project(b, row, f);
            for (int c = 0; c < detail::panel_width; ++c) {
                total += f[c] * f[c] * diagonal_[detail::panel_width * b + c];
            }
        }
        if (sweeping()) {
            const int done = panel_width_up_to(panel_);
            const Scalar taken = detail::dot(gain_.data(), row, done);
            total += taken * taken / alpha_;
        }
        return total;
    }

    [[nodiscard]] bool sweeping() const noexcept { return sweeping_ != 0; }

    /// Begins to fold in a row of p values, measured with a noise of this variance > 0.
    void begin(const Scalar* row, Scalar noise_variance) noexcept {
        for (int j = 0; j < columns_; ++j) {
            row_[j] = row[j];
        }
        begin_at(0, noise_variance);
    }

    /// Begins a measurement of parameter i alone, as precise as it takes to bring its variance back to
    /// `ceiling`; false, and nothing begun, if it is not above that. O(p).
    [[nodiscard]] bool begin_bound(int i, Scalar ceiling) noexcept {
        const Scalar present = parameter_variance(i);
        if (present <= ceiling) {
            return false;
        }
        clear(row_);
        clear(gain_);
        row_[i] = 1;
        begin_at(i / detail::panel_width, ceiling * (present / (present - ceiling)));
        return true;
    }

    /// Sweeps as far as the budget goes; true when all columns are done.
    [[nodiscard]] bool sweep(Budget& budget) noexcept {
        for (; panel_ < panel_count(); ++panel_) {
            if (!budget.spend(panel_cost(panel_, columns_))) {
                return false;
            }
            fold_panel(panel_);
        }
        return true;
    }

    /// Ends a sweep that is done: from now on the new covariance counts.
    void close() noexcept { sweeping_ = 0; }

    /// The row in hand, p values.
    [[nodiscard]] const Scalar* row() const noexcept { return row_.data(); }

    /// After a sweep: noise variance + h'Ph, and gain·that, p values.
    [[nodiscard]] Scalar alpha() const noexcept { return alpha_; }
    [[nodiscard]] const Scalar* gain() const noexcept { return gain_.data(); }

    /// P *= growth.
    void scale(Scalar growth) noexcept {
        for (int j = 0; j < columns_; ++j) {
            diagonal_[j] *= growth;
        }
    }

    /// Variance of one parameter, P_ii, while no sweep is under way. O(p).
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

    /// Multiply-adds of a sweep, and of the largest part that a sweep can be sliced into.
    [[nodiscard]] static constexpr std::int64_t sweep_cost(int columns) noexcept {
        std::int64_t total = 0;
        for (int b = 0; b < panel_count(columns); ++b) {
            total += panel_cost(b, columns);
        }
        return total;
    }
    [[nodiscard]] static constexpr std::int64_t largest_step(int columns) noexcept {
        return panel_cost(panel_count(columns) - 1, columns);
    }
    /// Of `variance`, and what it takes beyond that while a sweep is under way, at most.
    [[nodiscard]] static constexpr std::int64_t variance_cost(int columns) noexcept {
        std::int64_t total = 0;
        for (int b = 0; b < panel_count(columns); ++b) {
            total += projection_cost(b, columns) + 2 * detail::panel_width;
        }
        return total;
    }
    [[nodiscard]] static constexpr std::int64_t sweeping_variance_cost(int columns) noexcept {
        return std::int64_t{columns} + 2;
    }
    /// Of `scale` and `begin_bound`, at most.
    [[nodiscard]] static constexpr std::int64_t scale_and_bound_cost(int columns) noexcept {
        return std::int64_t{3} * columns;
    }

    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        visitor.array(self.panels_.data(), self.panels_.size());
        visitor.array(self.triangles_.data(), self.triangles_.size());
        visitor.positive_array(self.diagonal_.data(), self.diagonal_.size());
        visitor.array(self.row_.data(), self.row_.size());
        visitor.array(self.gain_.data(), self.gain_.size());
        visitor.positive_array(&self.alpha_, 1);
        visitor.ranged(self.panel_, 0, self.panel_count());
        visitor.ranged(self.sweeping_, 0, 1);
    }

  private:
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
    static constexpr int panel_count(int columns) noexcept { return padded(columns) / detail::panel_width; }
    static constexpr std::int64_t projection_cost(int b, int columns) noexcept {
        const int width = std::min(detail::panel_width, columns - detail::panel_width * b);
        return std::int64_t{16} * b + width * (width - 1) / 2;
    }
    /// Five for each column's gain, two for each element above the diagonal.
    static constexpr std::int64_t panel_cost(int b, int columns) noexcept {
        return projection_cost(b, columns) + std::int64_t{32} * b + 5 * detail::panel_width + 2 * 6;
    }

    using Panels = Storage<Scalar, panels_size(p)>;
    using Triangles = Storage<Scalar, triangles_size(p)>;

    [[nodiscard]] Columns zero_columns() const noexcept {
        return Columns::zeros(extent<padded(p)>(padded(columns_)));
    }

    template <class Array>
    static void clear(Array& array) noexcept {
        for (Scalar& value : array) {
            value = 0;
        }
    }

    [[nodiscard]] int panel_count() const noexcept { return panel_count(columns_); }
    [[nodiscard]] int panel_width_up_to(int panel) const noexcept {
        const int columns = detail::panel_width * panel;
        return columns < columns_ ? columns : static_cast<int>(columns_);
    }
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

    void begin_at(int panel, Scalar noise_variance) noexcept {
        alpha_ = noise_variance;
        panel_ = panel;
        sweeping_ = 1;
    }

    /// f = U'h for the four columns of panel b.
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

    [[no_unique_address]] Extent<p> columns_;
    Panels panels_;
    Triangles triangles_;
    Columns diagonal_;
    Columns row_;
    Columns gain_;
    Scalar alpha_ = 1; ///< the row's noise variance + h'Ph over the columns done
    int panel_ = 0;    ///< next panel to fold
    int sweeping_ = 0;
};

} // namespace dfdyn
