// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/vector.hpp"

namespace dfdyn::detail {

/// Columns that one pass of a sweep treats together, so that the row and the gain are read once for all of
/// them.
inline constexpr int panel_width = 4;

/// Where the last whole vector of elements `begin` … `count` - 1 ends.
template <int lanes>
constexpr int whole_vectors(int begin, int count) noexcept {
    return begin + (count - begin) / lanes * lanes;
}

/// Adds the products of elements `begin` … of `columns` columns with one row, `lanes` at a time as far as
/// they go; returns where that is.
template <class Scalar, int lanes, int columns>
int add_dots(const Scalar* matrix, const Scalar* row, int begin, int count,
             Scalar (&products)[columns]) noexcept {
    using Lanes = Vector<Scalar, lanes>;
    typename Lanes::Type partial[columns] = {};
    typename Lanes::Type x;
    typename Lanes::Type u;
    const int whole = whole_vectors<lanes>(begin, count);
    for (int i = begin; i < whole; i += lanes) {
        Lanes::load(row + i, x);
        for (int c = 0; c < columns; ++c) {
            Lanes::load(matrix + c * count + i, u);
            partial[c] += u * x;
        }
    }
    for (int c = 0; c < columns; ++c) {
        products[c] += Lanes::total(partial[c]);
    }
    return whole;
}

/// a'b over `count` elements.
template <class Scalar>
Scalar dot(const Scalar* a, const Scalar* b, int count) noexcept {
    Scalar product[1] = {};
    for (int i = add_dots<Scalar, wide<Scalar>>(a, b, 0, count, product); i < count; ++i) {
        product[0] += a[i] * b[i];
    }
    return product[0];
}

/// y += factor x over `count` elements.
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

/// The products of four columns, each `count` long (a multiple of four) and stored one after the other, with
/// one row.
template <class Scalar>
void panel_dots(const Scalar* columns, const Scalar* row, int count,
                Scalar (&products)[panel_width]) noexcept {
    for (Scalar& product : products) {
        product = 0;
    }
    const int done = add_dots<Scalar, wide<Scalar>>(columns, row, 0, count, products);
    add_dots<Scalar, panel_width>(columns, row, done, count, products);
}

template <class Scalar, int lanes>
int update_panel_from(Scalar* columns, Scalar* gain, int begin, int count, const Scalar (&v)[panel_width],
                      const Scalar (&mu)[panel_width]) noexcept {
    using Lanes = Vector<Scalar, lanes>;
    typename Lanes::Type k;
    typename Lanes::Type u;
    const int whole = whole_vectors<lanes>(begin, count);
    for (int i = begin; i < whole; i += lanes) {
        Lanes::load(gain + i, k);
        for (int c = 0; c < panel_width; ++c) {
            Lanes::load(columns + c * count + i, u);
            Lanes::store(u + mu[c] * k, columns + c * count + i);
            k += v[c] * u;
        }
        Lanes::store(k, gain + i);
    }
    return whole;
}

/// Bierman's update of four columns (as in `panel_dots`) above their diagonal block: for each column in turn
/// u += mu·gain, gain += v·u (the old u).
template <class Scalar>
void panel_update(Scalar* columns, Scalar* gain, int count, const Scalar (&v)[panel_width],
                  const Scalar (&mu)[panel_width]) noexcept {
    const int done = update_panel_from<Scalar, wide<Scalar>>(columns, gain, 0, count, v, mu);
    update_panel_from<Scalar, panel_width>(columns, gain, done, count, v, mu);
}

} // namespace dfdyn::detail
