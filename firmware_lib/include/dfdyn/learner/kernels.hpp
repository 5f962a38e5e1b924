// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/vector.hpp"

#include <algorithm>

namespace dfdyn::detail {

/// Columns that one pass of a sweep processes together, so that the row and the gain are read once for all of
/// them.
inline constexpr int panel_width = 4;

/// Rows per block of a panel: the lanes of a vector register, at least four. A block contains these rows of
/// each column of the panel. It is contiguous, so that every load has the alignment of the panel.
template <class Scalar>
inline constexpr int block_rows = std::max(panel_width, wide<Scalar>);

template <class Scalar>
inline constexpr int block_size = panel_width* block_rows<Scalar>;

/// Returns the end of the last whole vector of elements `begin` … `count` - 1.
template <int lanes>
constexpr int whole_vectors(int begin, int count) noexcept {
    return begin + (count - begin) / lanes * lanes;
}

/// Returns a'b over the elements that do not fill whole vectors: from `begin` on, fewer than 2 `lanes`.
template <class Scalar, int lanes>
Scalar dot_of_rest(const Scalar* a, const Scalar* b, int begin, int count) noexcept {
    if constexpr (lanes == 0) {
        return 0;
    } else {
        if (begin + lanes > count) {
            return dot_of_rest<Scalar, lanes / 2>(a, b, begin, count);
        }
        using Lanes = Vector<Scalar, lanes>;
        typename Lanes::Type x;
        typename Lanes::Type y;
        Lanes::load(a + begin, x);
        Lanes::load(b + begin, y);
        return Lanes::total(x * y) + dot_of_rest<Scalar, lanes / 2>(a, b, begin + lanes, count);
    }
}

/// Returns a'b over `count` elements.
template <class Scalar>
Scalar dot(const Scalar* a, const Scalar* b, int count) noexcept {
    constexpr int lanes = wide<Scalar>;
    using Wide = Vector<Scalar, lanes>;
    typename Wide::Type partial{};
    typename Wide::Type x;
    typename Wide::Type y;
    const int whole = whole_vectors<lanes>(0, count);
    for (int i = 0; i < whole; i += lanes) {
        Wide::load(a + i, x);
        Wide::load(b + i, y);
        partial += x * y;
    }
    return Wide::total(partial) + dot_of_rest<Scalar, lanes / 2>(a, b, whole, count);
}

/// Computes y += factor x over `count` elements.
template <class Scalar>
void add_scaled(Scalar factor, const Scalar* x, Scalar* y, int count) noexcept {
    using Wide = Vector<Scalar, wide<Scalar>>;
    typename Wide::Type from;
    typename Wide::Type to;
    const int whole = whole_vectors<wide<Scalar>>(0, count);
    for (int i = 0; i < whole; i += wide<Scalar>) {
        Wide::load(x + i, from);
        Wide::load(y + i, to);
        to += factor * from;
        Wide::store(to, y + i);
    }
    for (int i = whole; i < count; ++i) {
        y[i] += factor * x[i];
    }
}

/// Computes y += factor x with compensation: `rest` accumulates the rounding errors of y (T. J. Dekker's fast
/// two-sum, "A floating-point technique for extending the available precision", 1971). While |factor x| <
/// |y|, the sum y + rest has the precision of twice the digits; otherwise that of `add_scaled`.
template <class Scalar>
void add_compensated(Scalar factor, const Scalar* x, Scalar* y, Scalar* rest, int count) noexcept {
    using Wide = Vector<Scalar, wide<Scalar>>;
    typename Wide::Type from;
    typename Wide::Type to;
    typename Wide::Type kept;
    const int whole = whole_vectors<wide<Scalar>>(0, count);
    for (int i = 0; i < whole; i += wide<Scalar>) {
        Wide::load(x + i, from);
        Wide::load(y + i, to);
        Wide::load(rest + i, kept);
        const typename Wide::Type change = factor * from + kept;
        const typename Wide::Type sum = to + change;
        Wide::store(change - (sum - to), rest + i);
        Wide::store(sum, y + i);
    }
    for (int i = whole; i < count; ++i) {
        const Scalar change = factor * x[i] + rest[i];
        const Scalar sum = y[i] + change;
        rest[i] = change - (sum - y[i]);
        y[i] = sum;
    }
}

/// Factors of the update of four columns of a panel and of the gain.
template <class Scalar>
struct PanelFactors {
    Scalar v[panel_width];  ///< added to the gain, per unit of the column
    Scalar mu[panel_width]; ///< added to the column, per unit of the gain
};

/// Products of a panel's columns with a row, accumulated block by block.
template <class Scalar>
class PanelProducts {
  public:
    void add(const Scalar* block, const Scalar* row) noexcept {
        typename Lanes::Type x;
        typename Lanes::Type u;
        for (int i = 0; i < block_rows<Scalar>; i += wide<Scalar>) {
            Lanes::load(row + i, x);
            for (int c = 0; c < panel_width; ++c) {
                Lanes::load(block + c * block_rows<Scalar> + i, u);
                partial_[c] += u * x;
            }
        }
    }

    void total(Scalar (&products)[panel_width]) const noexcept {
        for (int c = 0; c < panel_width; ++c) {
            products[c] = Lanes::total(partial_[c]);
        }
    }

  private:
    using Lanes = Vector<Scalar, wide<Scalar>>;
    typename Lanes::Type partial_[panel_width] = {};
};

/// Bierman's update of one block: for each column in turn u += mu·gain, gain += v·u (with the old u).
template <class Scalar>
void update_block(Scalar* block, Scalar* gain, const PanelFactors<Scalar>& factors) noexcept {
    using Lanes = Vector<Scalar, wide<Scalar>>;
    typename Lanes::Type k;
    typename Lanes::Type u;
    for (int i = 0; i < block_rows<Scalar>; i += wide<Scalar>) {
        Lanes::load(gain + i, k);
        for (int c = 0; c < panel_width; ++c) {
            Scalar* const column = block + c * block_rows<Scalar> + i;
            Lanes::load(column, u);
            Lanes::store(u + factors.mu[c] * k, column);
            k += factors.v[c] * u;
        }
        Lanes::store(k, gain + i);
    }
}

/// Computes the products of a panel of `blocks` blocks with a row of the same length.
template <class Scalar>
[[gnu::always_inline]] inline void panel_products(const Scalar* panel, int blocks, const Scalar* row,
                                                  Scalar (&products)[panel_width]) noexcept {
    PanelProducts<Scalar> sums;
    for (int k = 0; k < blocks; ++k) {
        sums.add(panel + k * block_size<Scalar>, row + k * block_rows<Scalar>);
    }
    sums.total(products);
}

template <class Scalar>
[[gnu::always_inline]] inline void update_panel(Scalar* panel, int blocks, Scalar* gain,
                                                PanelFactors<Scalar> factors) noexcept {
    for (int k = 0; k < blocks; ++k) {
        update_block(panel + k * block_size<Scalar>, gain + k * block_rows<Scalar>, factors);
    }
}

/// Combines `update_panel` with `panel_products` of the panel `next`, which has at least as many blocks: the
/// next panel is loaded from memory while the present one is processed in the nearest cache.
template <class Scalar>
[[gnu::always_inline]] inline void
update_panel(Scalar* panel, int blocks, Scalar* gain, PanelFactors<Scalar> factors, const Scalar* next,
             int next_blocks, const Scalar* row, Scalar (&products)[panel_width]) noexcept {
    PanelProducts<Scalar> sums;
    for (int k = 0; k < blocks; ++k) {
        sums.add(next + k * block_size<Scalar>, row + k * block_rows<Scalar>);
        update_block(panel + k * block_size<Scalar>, gain + k * block_rows<Scalar>, factors);
    }
    for (int k = blocks; k < next_blocks; ++k) {
        sums.add(next + k * block_size<Scalar>, row + k * block_rows<Scalar>);
    }
    sums.total(products);
}

} // namespace dfdyn::detail
