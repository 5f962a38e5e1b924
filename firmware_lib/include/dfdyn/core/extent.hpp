// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

namespace dfdyn {

/// Marks a size that is known only at run time, in the host's tools. Firmware never uses it: every size is a
/// template argument, and the whole state is one object of constant size.
inline constexpr int dynamic = -1;

/// A size. Fixed sizes take no memory and fold to constants.
template <int value>
struct Extent {
    /// Returns the size.
    // It is a number: NOLINTNEXTLINE(google-explicit-constructor)
    constexpr operator int() const noexcept { return value; }
};

/// A size that is known at run time.
template <>
struct Extent<dynamic> {
    int value = 0; ///< the size, ≥ 0
    /// Returns the size.
    // It is a number: NOLINTNEXTLINE(google-explicit-constructor)
    constexpr operator int() const noexcept { return value; }
};

/// Makes an extent from a number. For a fixed extent the number must equal its value and is ignored.
template <int value>
constexpr Extent<value> extent([[maybe_unused]] int number) noexcept {
    if constexpr (value == dynamic) {
        return Extent<dynamic>{number};
    } else {
        return {};
    }
}

/// Returns the product of template sizes; `dynamic` if an operand is `dynamic`.
constexpr int product(int a, int b) noexcept { return a == dynamic || b == dynamic ? dynamic : a * b; }

/// Returns the sum of template sizes; `dynamic` if an operand is `dynamic`.
constexpr int sum(int a, int b) noexcept { return a == dynamic || b == dynamic ? dynamic : a + b; }

} // namespace dfdyn
