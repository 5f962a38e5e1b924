// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/kernels.hpp"
#include "dfdyn/learner/learner.hpp"

#include <algorithm>

namespace dfdyn {

/// The covariance P = U D U' of p parameters as its square-root-free Cholesky factor, and the sweep that
/// folds a row into it (G. J. Bierman, "Factorization Methods for Discrete Sequential Estimation", 1977): 1.5
/// p² multiply-adds without a square root, which also give the gain and the predictive variance.
///
/// U is stored in panels of four columns. Panel b contains its columns down to their unit diagonal, and zeros
/// below it to the end of a block (see `block_rows`). A sweep can therefore ignore the triangular shape:
/// zeros stay zeros and ones stay ones. Columns beyond p pad the last panel and have no effect. Memory about
/// p²/2 + 5 p scalars.
///
/// A sweep can stop after any panel and continue later. Until it is closed, `variance` refers exactly to the
/// old covariance: after j columns the updated part of P is a rank-one downdate of the old one, Σ_{i≤j} ū d̄
/// ū' = Σ_{i≤j} u d u' - g g'/α, with the partial gain g and α of the sweep.
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

    /// Sets P = `variance` I and discards a sweep in progress.
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
        sweep_ = Sweep::none;
    }

    /// Loads an initial factor: U above its diagonal by columns (p (p-1) / 2 values), and D (p values > 0).
    void load(const Scalar* unit_upper, const Scalar* diagonal) noexcept {
        for (int j = 0; j < columns_; ++j) {
            diagonal_[j] = diagonal[j];
            const Scalar* column = unit_upper + j * (j - 1) / 2;
            for (int i = 0; i < j; ++i) {
                element(*this, i, j) = column[i];
            }
        }
    }

    /// Returns h'Ph of a row h of p values; during a sweep, with the covariance before it. O(p²).
    [[nodiscard]] Scalar variance(const Scalar* row) const noexcept {
        Scalar total = 0;
        for (int b = 0; b < panel_count(); ++b) {
            Scalar f[width];
            project(b, row, f);
            for (int c = 0; c < width; ++c) {
                total += f[c] * f[c] * diagonal_[width * b + c];
            }
        }
        if (sweep_ == Sweep::fold) {
            const int done = width * panel_;
            const Scalar taken = detail::dot(gain_.data(), row, done < columns_ ? done : int{columns_});
            total += taken * taken / alpha_;
        }
        return total;
    }

    /// Begins to fold in a row of p values, measured with this noise variance > 0; with `keep` the sweep
    /// computes its `alpha` and `gain` only, and the covariance stays.
    void begin(const Scalar* row, Scalar noise_variance, bool keep) noexcept {
        for (int j = 0; j < columns_; ++j) {
            row_[j] = row[j];
        }
        clear(gain_);
        begin_at(0, noise_variance, keep ? Sweep::keep : Sweep::fold);
    }

    /// Begins a measurement of parameter i alone, whose noise is chosen such that its variance becomes
    /// `ceiling`. Returns false and begins nothing if the variance is not above `ceiling`. O(p).
    [[nodiscard]] bool begin_bound(int i, Scalar ceiling) noexcept {
        const Scalar present = parameter_variance(i);
        if (present <= ceiling) {
            return false;
        }
        clear(row_);
        clear(gain_);
        row_[i] = 1;
        begin_at(i / width, ceiling * (present / (present - ceiling)), Sweep::fold);
        return true;
    }

    /// Continues the sweep within the budget; returns true when all columns are done.
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

    /// Ends a completed sweep: from now on the new covariance is used.
    void close() noexcept { sweep_ = Sweep::none; }

    /// Returns the row of the present or last sweep, p values.
    [[nodiscard]] const Scalar* row() const noexcept { return row_.data(); }

    /// Results of a completed sweep: `alpha` is the noise variance + h'Ph, `gain` is alpha times the gain, p
    /// values.
    [[nodiscard]] Scalar alpha() const noexcept { return alpha_; }
    [[nodiscard]] const Scalar* gain() const noexcept { return gain_.data(); }

    /// Begins to reset the covariance to a prior's. Not during a sweep.
    void begin_reset() noexcept { panel_ = 0; }

    /// Resets the covariance to `variance` I, panel by panel within the budget; returns true when it is done.
    /// Meanwhile it is the covariance of the completed panels and, given those, of the others.
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

    /// Computes P *= growth, growth > 0. O(p).
    void scale(Scalar growth) noexcept {
        for (int j = 0; j < columns_; ++j) {
            diagonal_[j] *= growth;
        }
    }

    /// Returns the variance P_ii of one parameter, 0 ≤ i < p. Not during a sweep. O(p).
    [[nodiscard]] Scalar parameter_variance(int i) const noexcept {
        Scalar total = diagonal_[i];
        for (int j = i + 1; j < columns_; ++j) {
            total += upper(i, j) * upper(i, j) * diagonal_[j];
        }
        return total;
    }

    /// Returns an element of U above the diagonal, i < j.
    [[nodiscard]] Scalar upper(int i, int j) const noexcept { return element(*this, i, j); }
    [[nodiscard]] Scalar diagonal(int j) const noexcept { return diagonal_[j]; }

    /// Multiply-adds of a sweep, and of the largest indivisible part of a sweep.
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
    /// Multiply-adds of `reset` with a budget: one per element.
    [[nodiscard]] static constexpr std::int64_t reset_cost(int columns) noexcept {
        std::int64_t total = 0;
        for (int b = 0; b < panels_of(columns); ++b) {
            total += projection_cost(b);
        }
        return total;
    }
    /// Maximum multiply-adds of `variance`, and its additional cost during a sweep.
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
    /// Maximum multiply-adds of `scale` and `begin_bound`.
    [[nodiscard]] static constexpr std::int64_t scale_and_bound_cost(int columns) noexcept {
        return std::int64_t{3} * columns;
    }

    [[nodiscard]] static constexpr std::int64_t state_bytes(int columns) noexcept {
        return storage_bytes<Scalar>(panels_size(columns)) + 3 * storage_bytes<Scalar>(padded(columns));
    }

    /// Visits the factor by columns, so that a snapshot does not depend on the machine's layout.
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
        visitor.ranged(self.sweep_, Sweep::none, Sweep::keep);
    }

  private:
    /// Effect of the present sweep on the covariance.
    enum class Sweep : int { none, fold, keep };

    static constexpr int width = detail::panel_width;
    static constexpr int rows = detail::block_rows<Scalar>;
    static constexpr int size = detail::block_size<Scalar>;

    static constexpr int panels_of(int columns) noexcept { return (columns + width - 1) / width; }
    static constexpr int block_count(int panel) noexcept { return width * panel / rows + 1; }
    /// Returns the number of elements before a panel. Panels have 1, 2, 3 … blocks, with `rows` / `width`
    /// panels of each height.
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
    /// One multiply-add per element for its product, two for its update, and five per column for its part of
    /// the gain.
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

    void begin_at(int panel, Scalar noise_variance, Sweep sweep) noexcept {
        alpha_ = noise_variance;
        panel_ = panel;
        sweep_ = sweep;
    }

    /// Computes f = U'h for the four columns of panel b, with a row h of p values.
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

    /// Folds the row into the panels before `end`, at least one. The effect of a panel on the gain follows
    /// from U'h alone, so the next panel is multiplied with the row while the present one is updated.
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
            const Scalar next = alpha + f[c] * factors.v[c];
            factors.mu[c] = sweep_ == Sweep::fold ? -f[c] / alpha : Scalar(0);
            d *= sweep_ == Sweep::fold ? alpha / next : Scalar(1);
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
    Scalar alpha_ = 1; ///< noise variance of the row + h'Ph over the completed columns
    int panel_ = 0;    ///< next panel to fold
    Sweep sweep_ = Sweep::none;
};

} // namespace dfdyn
