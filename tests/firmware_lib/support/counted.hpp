// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace dfdyn::tests {

/// A number that counts the work done with its kind: one per product or quotient, 30 per function call, as
/// the library's cost functions do. Sums ride along with products.
struct Counted {
    double value = 0;
    static inline std::int64_t operations = 0;

    Counted() = default;
    // As plain numbers do: NOLINTNEXTLINE(google-explicit-constructor)
    Counted(double number) : value(number) {}

    static Counted counted(double number, std::int64_t cost = 1) {
        operations += cost;
        return {number};
    }

    friend Counted operator+(Counted a, Counted b) { return {a.value + b.value}; }
    friend Counted operator-(Counted a, Counted b) { return {a.value - b.value}; }
    friend Counted operator-(Counted a) { return {-a.value}; }
    friend Counted operator*(Counted a, Counted b) { return counted(a.value * b.value); }
    friend Counted operator/(Counted a, Counted b) { return counted(a.value / b.value); }
    Counted& operator+=(Counted other) { return *this = *this + other; }
    friend Counted sin(Counted a) { return counted(std::sin(a.value), 30); }
    friend Counted cos(Counted a) { return counted(std::cos(a.value), 30); }
    friend Counted tanh(Counted a) { return counted(std::tanh(a.value), 30); }
    friend Counted exp(Counted a) { return counted(std::exp(a.value), 30); }
};

} // namespace dfdyn::tests
