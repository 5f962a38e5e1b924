// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/vector.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <numbers>

namespace dfdyn {

/// Largest |argument| (rad) that `cos_sin` accepts.
template <class Scalar>
inline constexpr Scalar largest_cos_sin_argument = 8192;

namespace detail {

/// π/2 as a sum of parts, largest first. The products of all parts but the last with an integer below 2¹³ are
/// exact, and the last part contains the remainder. Subtracting the products in this order therefore loses no
/// accuracy (Cody, Waite, "Software Manual for the Elementary Functions", 1980).
template <class Scalar>
struct HalfPi;

template <>
struct HalfPi<float> {
    static constexpr float parts[] = {0x1.92p+0F, 0x1.fb4p-12F, 0x1.444p-24F, 0x1.68c234p-39F};
};

template <>
struct HalfPi<double> {
    static constexpr double parts[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
};

/// Number of Taylor coefficients that suffices on [-π/4, π/4]: the first omitted term is below the scalar's
/// precision.
template <class Scalar>
inline constexpr int taylor_terms = std::numeric_limits<Scalar>::digits <= 24 ? 5 : 8;

/// Coefficients of r² in cos r (parity 0) or (sin r)/r (parity 1), highest power first: ±1/(2i + parity)!.
template <class Scalar, int parity>
struct Taylor {
    static constexpr int count = taylor_terms<Scalar> + 1 - parity;
    Scalar coefficients[count] = {};

    constexpr Taylor() noexcept {
        for (int power = 0; power < count; ++power) {
            long double value = power % 2 == 0 ? 1 : -1;
            for (int factor = 2; factor <= 2 * power + parity; ++factor) {
                value /= factor;
            }
            coefficients[count - 1 - power] = static_cast<Scalar>(value);
        }
    }

    template <class VectorType>
    static void evaluate(const VectorType& square, VectorType& value) noexcept {
        constexpr Taylor taylor;
        value = VectorType{} + taylor.coefficients[0];
        for (int i = 1; i < count; ++i) {
            value = value * square + taylor.coefficients[i];
        }
    }
};

inline constexpr int narrowest_lane_count = 4; ///< of `cos_sin`

template <class Scalar>
inline constexpr int cos_sin_lane_count = std::max(narrowest_lane_count, wide<Scalar>);

/// Computes `lanes` cosines and sines at once. Sets each lane of `outside` whose argument is NaN or too
/// large.
template <class Scalar, int lanes>
void cos_sin_lanes(const Scalar* argument, Scalar amplitude, Scalar* cosine, Scalar* sine,
                   typename Vector<Scalar, lanes>::Mask& outside) noexcept {
    using Lanes = Vector<Scalar, lanes>;
    using Type = typename Lanes::Type;
    using Mask = typename Lanes::Mask;
    constexpr Scalar limit = largest_cos_sin_argument<Scalar>;
    constexpr Type zero{};
    Type x;
    Lanes::load(argument, x);
    const Mask inside = (x >= -limit) & (x <= limit);
    outside |= ~inside;
    Lanes::select(inside, x, zero, x);
    Type half;
    Lanes::select(x < zero, zero - Scalar(0.5), zero + Scalar(0.5), half);
    Mask quadrant;
    Lanes::truncate(x * static_cast<Scalar>(std::numbers::inv_pi * 2) + half, quadrant);
    Type whole;
    Lanes::convert(quadrant, whole);
    for (const Scalar part : HalfPi<Scalar>::parts) {
        x -= whole * part;
    }
    const Type square = x * x;
    Type c;
    Type s;
    Taylor<Scalar, 0>::evaluate(square, c);
    Taylor<Scalar, 1>::evaluate(square, s);
    c *= amplitude;
    s *= amplitude * x;
    const Mask odd = (quadrant & 1) != 0;
    Type value;
    Lanes::select(odd, s, c, value);
    Lanes::select(((quadrant + 1) & 2) != 0, -value, value, value);
    Lanes::store(value, cosine);
    Lanes::select(odd, c, s, value);
    Lanes::select((quadrant & 2) != 0, -value, value, value);
    Lanes::store(value, sine);
}

} // namespace detail

/// Computes cosine and sine of `count` arguments, each times `amplitude`; `cosine` may be `argument` itself.
/// Returns false if an argument is NaN or exceeds `largest_cos_sin_argument` in magnitude; the results are
/// then not usable. No branches and no calls, so the results are the same on all machines that round products
/// and sums in the same way. Cost: `cos_sin_cost`.
///
/// Absolute error below 1.2e-7 (float) and 3e-16 (double) for amplitude 1. For float the tests check every
/// argument. For double the bound is the sum of the following terms, which the tests verify one by one:
///  - two roundings of r = x - k π/2, 1.1e-16 (the products with all parts but the last are exact, and so is
///    the first difference);
///  - the first omitted term of the sine, 0.5e-16 (the cosine's is negligible);
///  - the roundings of the last sum and of the products after it, 1.2e-16; the earlier terms of Horner's
///    scheme are small.
template <class Scalar>
bool cos_sin(const Scalar* argument, int count, Scalar amplitude, Scalar* cosine, Scalar* sine) noexcept {
    constexpr int lanes = detail::cos_sin_lane_count<Scalar>;
    typename detail::Vector<Scalar, lanes>::Mask outside{};
    int i = 0;
    for (; i + lanes <= count; i += lanes) {
        detail::cos_sin_lanes<Scalar, lanes>(argument + i, amplitude, cosine + i, sine + i, outside);
    }
    if (i < count) {
        Scalar padded[3][lanes] = {};
        std::copy_n(argument + i, count - i, padded[0]);
        detail::cos_sin_lanes<Scalar, lanes>(padded[0], amplitude, padded[1], padded[2], outside);
        std::copy_n(padded[1], count - i, cosine + i);
        std::copy_n(padded[2], count - i, sine + i);
    }
    bool inside = true;
    for (int lane = 0; lane < lanes; ++lane) {
        inside = inside && outside[lane] == 0;
    }
    return inside;
}

/// A scalar that `cos_sin` supports. A scalar that carries derivatives provides its own functions.
template <class Scalar>
concept CosSinScalar = requires {
    detail::HalfPi<Scalar>::parts;
};

/// Computes cosine and sine of one argument; NaN where `cos_sin` returns false.
template <class Scalar>
void cos_sin_of(const Scalar& argument, Scalar& cosine, Scalar& sine) noexcept {
    if constexpr (CosSinScalar<Scalar>) {
        if (!cos_sin(&argument, 1, Scalar(1), &cosine, &sine)) {
            cosine = sine = std::numeric_limits<Scalar>::quiet_NaN();
        }
    } else {
        cosine = cos(argument);
        sine = sin(argument);
    }
}

/// Stack bytes of `cos_sin`: three padded vectors, and the vectors that find no register (measured, over the
/// whole stack).
template <class Scalar>
inline constexpr std::int64_t cos_sin_bytes = std::int64_t{22} * detail::cos_sin_lane_count<Scalar> *
                                              sizeof(Scalar);

/// Multiply-adds of `cos_sin`. Per argument, padded to whole vectors of the narrowest kind: one for the
/// quadrant, one for each part of π/2, the two polynomials with their square, and the amplitude. Wider
/// vectors are not counted, so that the cost is the same on every machine: they pad further, with fewer
/// instructions.
template <class Scalar>
constexpr std::int64_t cos_sin_cost(int count) noexcept {
    constexpr int lanes = detail::narrowest_lane_count;
    constexpr auto parts = static_cast<int>(std::size(detail::HalfPi<Scalar>::parts));
    const std::int64_t vectors = (count + lanes - 1) / lanes;
    return vectors * lanes * (1 + parts + 2 * detail::taylor_terms<Scalar> + 3);
}

} // namespace dfdyn
