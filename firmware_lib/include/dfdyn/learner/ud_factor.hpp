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
/// U is stored in panels of four columns: panel b holds its columns down to their diagonal, of ones, and
/// zeros below it to the end of a block (see `block_rows`). So a sweep needs to know nothing of the triangle:
/// zeros stay zeros and ones stay ones. Columns beyond p fill the last panel and do nothing. Memory about
/// p²/2 + 5 p, in scalars.
///
/// A sweep can stop after any panel and go on later. Until it is closed `variance` is that of the old
/// covariance, exactly: after j columns the part of P already updated is that of a rank-one downdate,
/// Σ_{i≤j} ū d̄ ū' = Σ_{i≤j} u d u' - g g'/α, with the partial gain g and α that the sweep carries.
template <class Scalar, int p>
class UdFactor {
  public:
    static constexpr int padded(int columns) noexcept {
        constexpr int whole = detail::block_rows<Scalar>;
        return columns == dynamic ? dynamic : (columns + whole - 1) / whole * whole;
    }

    /// A row or a gain, padded with zeros to whole blocks.
    using Columns = Storage<Scalar, padded(p)>;

    explicit UdFactor(Extent<p> columns) noexcept
        : columns_(columns), panels_(Panels::zeros(extent<panels_size(p)>(panels_size(columns)))),
          diagonal_(zero_columns()), row_(zero_columns()), gain_(zero_columns()) {}

    /// P = `variance` I; forgets a sweep under way.
    void reset(Scalar variance) noexcept {
        clear(panels_);
        for (int j = 0; j < width * panel_count(); ++j) {
            element(*this, j, j) = 1;
        }
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
                element(*this, i, j) = column[i];
            }
        }
    }

    /// h'Ph of a row h of p values, under a sweep that of the covariance before it. O(p²).
    [[nodiscard]] Scalar variance(const Scalar* row) const noexcept {
        Scalar total = 0;
        for (int b = 0; b < panel_count(); ++b) {
            Scalar f[width];
            project(b, row, f);
            for (int c = 0; c < width; ++c) {
                total += f[c] * f[c] * diagonal_[width * b + c];
            }
        }
        if (sweeping()) {
            const int done = width * panel_;
            const Scalar taken = detail::dot(gain_.data(), row, done < columns_ ? done : int{columns_});
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
        clear(gain_);
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
        begin_at(i / width, ceiling * (present / (present - ceiling)));
        return true;
    }

    /// Sweeps as far as the budget goes; true when all columns are done.
    [[nodiscard]] bool sweep(Budget& budget) noexcept {
        int end = panel_;
        while (end < panel_count() && budget.spend(panel_cost(end))) {
            ++end;
        }
        if (panel_ < end) {
            fold_panels(end);
        }
        return panel_ == panel_count();
    }

    /// Ends a sweep that is done: from now on the new covariance counts.
    void close() noexcept { sweeping_ = 0; }

    /// The row in hand, p values.
    [[nodiscard]] const Scalar* row() const noexcept { return row_.data(); }

    /// After a sweep: noise variance + h'Ph, and gain·that, p values.
    [[nodiscard]] Scalar alpha() const noexcept { return alpha_; }
    [[nodiscard]] const Scalar* gain() const noexcept { return gain_.data(); }

    /// Begins to take the covariance back to that of a prior; not while a sweep is under way.
    void begin_reset() noexcept { panel_ = 0; }

    /// Takes the covariance to `variance` I, panel by panel as far as the budget goes; true when it is done.
    /// In between it is that of the panels done and, given them, of the others.
    [[nodiscard]] bool reset(Scalar variance, Budget& budget) noexcept {
        for (; panel_ < panel_count(); ++panel_) {
            if (!budget.spend(projection_cost(panel_))) {
                return false;
            }
            std::fill_n(panel(panel_), size * block_count(panel_), Scalar(0));
            for (int j = width * panel_; j < width * (panel_ + 1); ++j) {
                element(*this, j, j) = 1;
                diagonal_[j] = variance;
            }
        }
        return true;
    }

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
    [[nodiscard]] Scalar upper(int i, int j) const noexcept { return element(*this, i, j); }
    [[nodiscard]] Scalar diagonal(int j) const noexcept { return diagonal_[j]; }

    /// Multiply-adds of a sweep, and of the largest part that a sweep can be sliced into.
    [[nodiscard]] static constexpr std::int64_t sweep_cost(int columns) noexcept {
        std::int64_t total = 0;
        for (int b = 0; b < panels_of(columns); ++b) {
            total += panel_cost(b);
        }
        return total;
    }
    [[nodiscard]] static constexpr std::int64_t largest_step(int columns) noexcept {
        return panel_cost(panels_of(columns) - 1);
    }
    /// Of `reset` with a budget: one for each element.
    [[nodiscard]] static constexpr std::int64_t reset_cost(int columns) noexcept {
        std::int64_t total = 0;
        for (int b = 0; b < panels_of(columns); ++b) {
            total += projection_cost(b);
        }
        return total;
    }
    /// Of `variance`, and what it takes beyond that while a sweep is under way, at most.
    [[nodiscard]] static constexpr std::int64_t variance_cost(int columns) noexcept {
        std::int64_t total = 0;
        for (int b = 0; b < panels_of(columns); ++b) {
            total += projection_cost(b) + 2 * width;
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

    [[nodiscard]] static constexpr std::int64_t state_bytes(int columns) noexcept {
        return storage_bytes<Scalar>(panels_size(columns)) + 3 * storage_bytes<Scalar>(padded(columns));
    }

    /// Column after column, so that every machine writes the same.
    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        for (int j = 1; j < self.columns_; ++j) {
            if (visitor.template skips<Scalar>(j)) {
                continue;
            }
            for (int i = 0; i < j; i += rows) {
                visitor.array(&element(self, i, j), i + rows < j ? rows : j - i);
            }
        }
        visitor.positive_array(self.diagonal_.data(), self.columns_);
        visitor.array(self.row_.data(), self.columns_);
        visitor.array(self.gain_.data(), self.columns_);
        visitor.positive_array(&self.alpha_, 1);
        visitor.ranged(self.panel_, 0, self.panel_count());
        visitor.ranged(self.sweeping_, 0, 1);
    }

  private:
    static constexpr int width = detail::panel_width;
    static constexpr int rows = detail::block_rows<Scalar>;
    static constexpr int size = detail::block_size<Scalar>;

    static constexpr int panels_of(int columns) noexcept { return (columns + width - 1) / width; }
    static constexpr int block_count(int panel) noexcept { return width * panel / rows + 1; }
    /// Elements before a panel: 1 … whole blocks, so many panels each, and some of one block more.
    static constexpr int panel_offset(int panel) noexcept {
        constexpr int panels = rows / width;
        const int whole = panel / panels;
        return size * (panels * whole * (whole + 1) / 2 + panel % panels * (whole + 1));
    }
    static constexpr int panels_size(int columns) noexcept {
        return columns == dynamic ? dynamic : panel_offset(panels_of(columns));
    }
    static constexpr std::int64_t projection_cost(int panel) noexcept {
        return std::int64_t{size} * block_count(panel);
    }
    /// One for each element's product, two for its update, five for each column's part of the gain.
    static constexpr std::int64_t panel_cost(int panel) noexcept {
        return 3 * projection_cost(panel) + 5 * width;
    }

    using Factors = detail::PanelFactors<Scalar>;
    using Panels = Storage<Scalar, panels_size(p)>;

    [[nodiscard]] Columns zero_columns() const noexcept {
        return Columns::zeros(extent<padded(p)>(padded(columns_)));
    }

    template <class Array>
    static void clear(Array& array) noexcept {
        for (Scalar& value : array) {
            value = 0;
        }
    }

    [[nodiscard]] int panel_count() const noexcept { return panels_of(columns_); }
    [[nodiscard]] Scalar* panel(int b) noexcept { return panels_.data() + panel_offset(b); }
    [[nodiscard]] const Scalar* panel(int b) const noexcept { return panels_.data() + panel_offset(b); }

    template <class Self>
    static auto& element(Self& self, int i, int j) noexcept {
        return self.panel(j / width)[i / rows * size + j % width * rows + i % rows];
    }

    void begin_at(int panel, Scalar noise_variance) noexcept {
        alpha_ = noise_variance;
        panel_ = panel;
        sweeping_ = 1;
    }

    /// f = U'h for the four columns of panel b, of a row of p values.
    void project(int b, const Scalar* row, Scalar (&f)[width]) const noexcept {
        const int blocks = block_count(b);
        if (rows * blocks <= columns_) {
            detail::panel_products(panel(b), blocks, row, f);
            return;
        }
        Scalar last[rows] = {};
        const int first = rows * (blocks - 1);
        std::copy(row + first, row + columns_, last);
        Scalar rest[width];
        detail::panel_products(panel(b), blocks - 1, row, f);
        detail::panel_products(panel(b) + size * (blocks - 1), 1, last, rest);
        for (int c = 0; c < width; ++c) {
            f[c] += rest[c];
        }
    }

    /// Folds the row into the panels before `end`, at least one. What a panel does to the gain follows from
    /// U'h alone: while one panel is updated, the next is already multiplied with the row.
    void fold_panels(int end) noexcept {
        Scalar f[width];
        detail::panel_products(panel(panel_), block_count(panel_), row_.data(), f);
        for (; panel_ + 1 < end; ++panel_) {
            const Factors factors = fold_diagonal(panel_, f);
            detail::update_panel(panel(panel_), block_count(panel_), gain_.data(), factors, panel(panel_ + 1),
                                 block_count(panel_ + 1), row_.data(), f);
        }
        detail::update_panel(panel(panel_), block_count(panel_), gain_.data(), fold_diagonal(panel_, f));
        ++panel_;
    }

    [[nodiscard]] Factors fold_diagonal(int b, const Scalar (&f)[width]) noexcept {
        Factors factors;
        Scalar alpha = alpha_;
        for (int c = 0; c < width; ++c) {
            Scalar& d = diagonal_[width * b + c];
            factors.v[c] = d * f[c];
            factors.mu[c] = -f[c] / alpha;
            const Scalar next = alpha + f[c] * factors.v[c];
            d *= alpha / next;
            alpha = next;
        }
        alpha_ = alpha;
        return factors;
    }

    [[no_unique_address]] Extent<p> columns_;
    Panels panels_;
    Columns diagonal_;
    Columns row_;
    Columns gain_;
    Scalar alpha_ = 1; ///< the row's noise variance + h'Ph over the columns done
    int panel_ = 0;    ///< next panel to fold
    int sweeping_ = 0;
};

} // namespace dfdyn
