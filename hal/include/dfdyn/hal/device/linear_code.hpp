// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/frame.hpp"

namespace dfdyn::hal {

/// A number of n bits that a motor sends for a value in ±maximum: value = code / (2^n - 1) · 2 maximum -
/// maximum. Codes saturate.
struct LinearCode {
    Signal signal;

    [[nodiscard]] constexpr double largest() const noexcept {
        return static_cast<double>((std::uint64_t{1} << static_cast<unsigned>(signal.length)) - 1);
    }
    [[nodiscard]] constexpr double value(const Frame& frame, double maximum) const noexcept {
        return signal.extract({frame.data.data(), 8}) / largest() * 2 * maximum - maximum;
    }
    void insert(double value, double maximum, Frame& frame) const noexcept {
        signal.insert({frame.data.data(), 8}, (value + maximum) / (2 * maximum) * largest());
    }
    /// Returns the difference of the values of consecutive codes.
    [[nodiscard]] constexpr double step(double maximum) const noexcept { return 2 * maximum / largest(); }
    [[nodiscard]] constexpr bool is_at_end(const Frame& frame) const noexcept {
        return signal.is_at_end({frame.data.data(), 8});
    }
};

/// Returns a big-endian code whose highest bit is bit 7 - `bit` % 8 of byte `bit` / 8.
constexpr LinearCode big_endian_code(int bit, int bits) noexcept {
    return {{.start_bit = bit / 8 * 8 + 7 - bit % 8, .length = bits, .byte_order = ByteOrder::motorola}};
}

} // namespace dfdyn::hal
