// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/features/cos_sin.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace dfdyn::tests {

inline std::int64_t counted_operations = 0;

/// A number that counts its operations, as defined by `Budget`. Otherwise it behaves like `Real`, so that it
/// can replace a plain number.
template <class Real>
struct Counted {
    Real value = 0;

    Counted() = default;
    template <class Number>
    requires std::is_arithmetic_v<Number>
    // Implicit, as for plain numbers: NOLINTNEXTLINE(google-explicit-constructor)
    constexpr Counted(Number number) : value(static_cast<Real>(number)) {}
    // For comparisons and inspection: NOLINTNEXTLINE(google-explicit-constructor)
    constexpr operator Real() const { return value; }

    static Counted counted(Real number, int cost = 1) {
        counted_operations += cost;
        return {number};
    }

    friend Counted operator+(Counted a, Counted b) { return {a.value + b.value}; }
    friend Counted operator-(Counted a, Counted b) { return {a.value - b.value}; }
    friend Counted operator*(Counted a, Counted b) { return counted(a.value * b.value); }
    friend Counted operator/(Counted a, Counted b) { return counted(a.value / b.value); }
    friend Counted operator-(Counted a) { return {-a.value}; }
    Counted& operator+=(Counted other) { return *this = *this + other; }
    Counted& operator-=(Counted other) { return *this = *this - other; }
    Counted& operator*=(Counted other) { return *this = *this * other; }
    Counted& operator/=(Counted other) { return *this = *this / other; }

    friend Counted sqrt(Counted a) { return counted(std::sqrt(a.value), function_cost); }
    friend Counted log(Counted a) { return counted(std::log(a.value), function_cost); }
    friend Counted exp(Counted a) { return counted(std::exp(a.value), function_cost); }
    friend Counted sin(Counted a) { return counted(std::sin(a.value), function_cost); }
    friend Counted cos(Counted a) { return counted(std::cos(a.value), function_cost); }
    friend Counted tanh(Counted a) { return counted(std::tanh(a.value), function_cost); }
    friend Counted hypot(Counted a, Counted b) {
        return counted(std::hypot(a.value, b.value), function_cost);
    }
};

// Operators with a plain number on one side: without them, the conversions of both types would be ambiguous.
template <class Number>
concept Plain = std::is_arithmetic_v<Number>;
template <class Real, Plain Number>
Counted<Real> operator+(Counted<Real> a, Number b) {
    return a + Counted<Real>(b);
}
template <class Real, Plain Number>
Counted<Real> operator-(Counted<Real> a, Number b) {
    return a - Counted<Real>(b);
}
template <class Real, Plain Number>
Counted<Real> operator*(Counted<Real> a, Number b) {
    return a * Counted<Real>(b);
}
template <class Real, Plain Number>
Counted<Real> operator/(Counted<Real> a, Number b) {
    return a / Counted<Real>(b);
}
template <class Real, Plain Number>
Counted<Real> operator+(Number a, Counted<Real> b) {
    return Counted<Real>(a) + b;
}
template <class Real, Plain Number>
Counted<Real> operator-(Number a, Counted<Real> b) {
    return Counted<Real>(a) - b;
}
template <class Real, Plain Number>
Counted<Real> operator*(Number a, Counted<Real> b) {
    return Counted<Real>(a) * b;
}
template <class Real, Plain Number>
Counted<Real> operator/(Number a, Counted<Real> b) {
    return Counted<Real>(a) / b;
}

/// Integers and conditions for `CountedLanes`; their operations do not count.
template <int lanes>
struct WholeLanes {
    std::int64_t lane[lanes] = {};

    std::int64_t& operator[](int i) { return lane[i]; }
    const std::int64_t& operator[](int i) const { return lane[i]; }

    template <class Operation>
    static WholeLanes each(Operation operation) {
        WholeLanes result;
        for (int i = 0; i < lanes; ++i) {
            result.lane[i] = operation(i);
        }
        return result;
    }
    friend WholeLanes operator&(const WholeLanes& a, const WholeLanes& b) {
        return each([&](int i) { return a[i] & b[i]; });
    }
    friend WholeLanes operator&(const WholeLanes& a, int b) {
        return each([&](int i) { return a[i] & b; });
    }
    friend WholeLanes operator+(const WholeLanes& a, int b) {
        return each([&](int i) { return a[i] + b; });
    }
    friend WholeLanes operator!=(const WholeLanes& a, int b) {
        return each([&](int i) { return a[i] != b ? -1 : 0; });
    }
    friend WholeLanes operator~(const WholeLanes& a) {
        return each([&](int i) { return ~a[i]; });
    }
    WholeLanes& operator|=(const WholeLanes& other) {
        return *this = each([&](int i) { return lane[i] | other[i]; });
    }
};

/// A vector register of counted numbers: the operations of each lane count.
template <class Real, int lanes>
struct CountedLanes {
    using Scalar = Counted<Real>;
    Scalar lane[lanes];

    Scalar& operator[](int i) { return lane[i]; }
    const Scalar& operator[](int i) const { return lane[i]; }

    template <class Operation>
    static CountedLanes each(Operation operation) {
        CountedLanes result;
        for (int i = 0; i < lanes; ++i) {
            result.lane[i] = operation(i);
        }
        return result;
    }
    friend CountedLanes operator+(const CountedLanes& a, const CountedLanes& b) {
        return each([&](int i) { return a[i] + b[i]; });
    }
    friend CountedLanes operator-(const CountedLanes& a, const CountedLanes& b) {
        return each([&](int i) { return a[i] - b[i]; });
    }
    friend CountedLanes operator*(const CountedLanes& a, const CountedLanes& b) {
        return each([&](int i) { return a[i] * b[i]; });
    }
    friend CountedLanes operator-(const CountedLanes& a) {
        return each([&](int i) { return -a[i]; });
    }
    friend CountedLanes operator+(const CountedLanes& a, Scalar b) { return a + filled(b); }
    friend CountedLanes operator-(const CountedLanes& a, Scalar b) { return a - filled(b); }
    friend CountedLanes operator*(const CountedLanes& a, Scalar b) { return a * filled(b); }
    friend CountedLanes operator*(Scalar a, const CountedLanes& b) { return filled(a) * b; }
    friend WholeLanes<lanes> operator<(const CountedLanes& a, const CountedLanes& b) {
        return WholeLanes<lanes>::each([&](int i) { return a[i] < b[i] ? -1 : 0; });
    }
    friend WholeLanes<lanes> operator<=(const CountedLanes& a, Scalar b) {
        return WholeLanes<lanes>::each([&](int i) { return a[i] <= b ? -1 : 0; });
    }
    friend WholeLanes<lanes> operator>=(const CountedLanes& a, Scalar b) {
        return WholeLanes<lanes>::each([&](int i) { return a[i] >= b ? -1 : 0; });
    }
    CountedLanes& operator+=(const CountedLanes& other) { return *this = *this + other; }
    CountedLanes& operator-=(const CountedLanes& other) { return *this = *this - other; }
    CountedLanes& operator*=(const CountedLanes& other) { return *this = *this * other; }
    CountedLanes& operator*=(Scalar factor) { return *this = *this * factor; }

    static CountedLanes filled(Scalar value) {
        return each([&](int /*i*/) { return value; });
    }
};

} // namespace dfdyn::tests

/// The limits of the underlying number.
template <class Real>
struct std::numeric_limits<dfdyn::tests::Counted<Real>> : std::numeric_limits<Real> {
    using Number = dfdyn::tests::Counted<Real>;
    static constexpr Number max() noexcept { return {std::numeric_limits<Real>::max()}; }
    static constexpr Number infinity() noexcept { return {std::numeric_limits<Real>::infinity()}; }
};

namespace dfdyn::detail {

template <class Real>
struct HalfPi<tests::Counted<Real>> : HalfPi<Real> {};

/// As `cos_sin_cost` counts on every machine.
template <class Real>
inline constexpr int cos_sin_lane_count<tests::Counted<Real>> = narrowest_lane_count;

template <class Real, int lanes>
requires(lanes > 1) struct Vector<tests::Counted<Real>, lanes> {
    using Scalar = tests::Counted<Real>;
    using Type = tests::CountedLanes<Real, lanes>;
    using Mask = tests::WholeLanes<lanes>;

    static void load(const Scalar* address, Type& vector) noexcept {
        vector = Type::each([&](int i) { return address[i]; });
    }
    static void store(const Type& vector, Scalar* address) noexcept {
        for (int i = 0; i < lanes; ++i) {
            address[i] = vector[i];
        }
    }
    static Scalar total(const Type& vector) noexcept {
        Scalar result = 0;
        for (int i = 0; i < lanes; ++i) {
            result += vector[i];
        }
        return result;
    }
    static void select(const Mask& condition, const Type& yes, const Type& no, Type& result) noexcept {
        result = Type::each([&](int i) { return condition[i] != 0 ? yes[i] : no[i]; });
    }
    static void truncate(const Type& vector, Mask& whole) noexcept {
        for (int i = 0; i < lanes; ++i) {
            whole[i] = static_cast<std::int64_t>(vector[i].value);
        }
    }
    static void convert(const Mask& whole, Type& vector) noexcept {
        vector = Type::each([&](int i) { return Scalar(whole[i]); });
    }
};

} // namespace dfdyn::detail
