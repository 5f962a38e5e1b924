// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

namespace dfdyn::hal {

/// Unsigned integer type with the size of `T`.
template <class T>
using BytesOf = std::conditional_t<sizeof(T) == 2, std::uint16_t,
                                   std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>;

/// Types of the numbers in frames: integers and IEEE 754 floats of 2, 4 or 8 bytes.
template <class T>
concept Loadable = (std::integral<T> || std::floating_point<T>)&&(sizeof(T) == 2 || sizeof(T) == 4 ||
                                                                  sizeof(T) == 8);

/// Decodes a little-endian number at `bytes`, which need not be aligned. Independent of the host's byte
/// order.
template <Loadable T>
[[nodiscard]] constexpr T load_little(const std::uint8_t* bytes) noexcept {
    std::uint64_t value = 0;
    for (std::size_t i = sizeof(T); i > 0; --i) {
        value = value << 8 | bytes[i - 1];
    }
    return std::bit_cast<T>(static_cast<BytesOf<T>>(value));
}

/// Decodes a big-endian number at `bytes`, which need not be aligned. Independent of the host's byte order.
template <Loadable T>
[[nodiscard]] constexpr T load_big(const std::uint8_t* bytes) noexcept {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        value = value << 8 | bytes[i];
    }
    return std::bit_cast<T>(static_cast<BytesOf<T>>(value));
}

template <Loadable T>
constexpr void store_little(std::uint8_t* bytes, T number) noexcept {
    const std::uint64_t value = std::bit_cast<BytesOf<T>>(number);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
}

template <Loadable T>
constexpr void store_big(std::uint8_t* bytes, T number) noexcept {
    const std::uint64_t value = std::bit_cast<BytesOf<T>>(number);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        bytes[sizeof(T) - 1 - i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
}

/// Rounds `value` to the nearest integer and clamps it to the range of T, like an analog-to-digital
/// converter. Returns 0 for NaN.
template <std::integral T>
requires(sizeof(T) <= 4) [[nodiscard]] inline T saturated(double value) noexcept {
    constexpr auto lowest = static_cast<double>(std::numeric_limits<T>::min());
    constexpr auto highest = static_cast<double>(std::numeric_limits<T>::max());
    return std::isnan(value) ? T{} : static_cast<T>(std::clamp(std::round(value), lowest, highest));
}

/// Returns true if a number is at the end of its type's range, where converters and controllers saturate. The
/// lower end is -max; min counts as well.
template <std::signed_integral T>
[[nodiscard]] constexpr bool is_at_end(T number) noexcept {
    return number >= std::numeric_limits<T>::max() || number <= -std::numeric_limits<T>::max();
}

[[nodiscard]] constexpr double magnitude(double value) noexcept { return value < 0 ? -value : value; }

/// a - b modulo 2^64: time stamps are arbitrary and must not overflow.
[[nodiscard]] constexpr std::int64_t wrapping_difference(std::int64_t a, std::int64_t b) noexcept {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}
/// a + b modulo 2^64.
[[nodiscard]] constexpr std::int64_t wrapping_sum(std::int64_t a, std::int64_t b) noexcept {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

enum class ByteOrder : std::uint8_t {
    /// `@1` in a DBC: the start bit is the lowest bit, and the number continues at higher bits and bytes
    intel,
    /// `@0` in a DBC: the start bit is the highest bit, and the number continues at lower bits and higher
    /// bytes
    motorola
};

enum class Encoding : std::uint8_t {
    unsigned_integer, ///< `+` in a DBC
    signed_integer,   ///< `-` in a DBC, two's complement
    float32,          ///< SIG_VALTYPE_ 1; 32 bits
    float64           ///< SIG_VALTYPE_ 2; 64 bits
};

/// A number at some position in a frame's data, as described in a DBC file. Bit b is bit b % 8 of byte b / 8,
/// where bit 0 is the least significant one.
struct Signal {
    int start_bit = 0;
    int length = 8; ///< bits, 1 … 64
    ByteOrder byte_order = ByteOrder::intel;
    Encoding encoding = Encoding::unsigned_integer;
    double factor = 1; ///< physical = factor * raw + offset
    double offset = 0;

    /// Returns true if the signal is well-formed and lies within `bytes` bytes of data.
    [[nodiscard]] constexpr bool fits(int bytes) const noexcept {
        const bool whole = length >= 1 && length <= 64 && start_bit >= 0 && start_bit / 8 < bytes;
        const bool sized = (encoding != Encoding::float32 || length == 32) &&
                           (encoding != Encoding::float64 || length == 64);
        return whole && sized && last_byte() < bytes;
    }

    /// Returns the bits of the signal as an unsigned integer. Requires `fits(data.size())`. O(length / 8).
    [[nodiscard]] constexpr std::uint64_t extract_raw(std::span<const std::uint8_t> data) const noexcept {
        std::uint64_t raw = 0;
        for_each_piece([&](std::size_t byte, int shift, int width, int place) {
            raw |= (data[byte] >> shift & mask(width)) << place;
        });
        return raw;
    }

    /// Replaces the signal's bits by the lowest bits of `raw` and leaves all other bits unchanged. Requires
    /// `fits(data.size())`.
    constexpr void insert_raw(std::span<std::uint8_t> data, std::uint64_t raw) const noexcept {
        for_each_piece([&](std::size_t byte, int shift, int width, int place) {
            const std::uint64_t bits = (raw >> place & mask(width)) << shift;
            data[byte] = static_cast<std::uint8_t>((data[byte] & ~(mask(width) << shift)) | bits);
        });
    }

    /// Returns true if the signal is an integer at an end of its range. Requires `fits(data.size())`.
    [[nodiscard]] constexpr bool is_at_end(std::span<const std::uint8_t> data) const noexcept {
        const std::uint64_t raw = extract_raw(data);
        const std::uint64_t highest = mask(length) >> 1U;
        switch (encoding) {
        case Encoding::unsigned_integer:
            return raw == 0 || raw == mask(length);
        case Encoding::signed_integer:
            return raw == highest || raw == highest + 1 || raw == highest + 2;
        case Encoding::float32:
        case Encoding::float64:
            break;
        }
        return false;
    }

    /// Physical size of one count of an integer, and of its whole range of counts. Both are 0 for a float.
    [[nodiscard]] constexpr double step() const noexcept { return is_integer() ? magnitude(factor) : 0; }
    [[nodiscard]] constexpr double span() const noexcept {
        double counts = 1;
        for (int bit = 0; bit < length; ++bit) {
            counts *= 2;
        }
        return counts * step();
    }

    /// Returns the physical value. Integers of more than 53 bits are rounded to a double. Requires
    /// `fits(data.size())`.
    [[nodiscard]] constexpr double extract(std::span<const std::uint8_t> data) const noexcept {
        return factor * number(extract_raw(data)) + offset;
    }

    /// Encodes a physical value, rounded to the nearest value that the signal can represent and clamped to
    /// its range. An integer signal encodes NaN as 0. Requires `fits(data.size())` and a factor other than 0.
    void insert(std::span<std::uint8_t> data, double physical) const noexcept {
        insert_raw(data, raw_of((physical - offset) / factor));
    }

  private:
    [[nodiscard]] constexpr bool is_integer() const noexcept {
        return encoding == Encoding::unsigned_integer || encoding == Encoding::signed_integer;
    }

    [[nodiscard]] static constexpr std::uint64_t mask(int width) noexcept {
        return width >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
    }

    [[nodiscard]] constexpr int last_byte() const noexcept {
        const int bits_before = byte_order == ByteOrder::intel ? start_bit % 8 : 7 - start_bit % 8;
        return start_bit / 8 + (bits_before + length - 1) / 8;
    }

    /// Calls use(byte, shift in the byte, width, position in the number) for the signal's bits in each byte.
    template <class Use>
    constexpr void for_each_piece(Use use) const noexcept {
        int bit = start_bit;
        for (int done = 0; done < length;) {
            const bool intel = byte_order == ByteOrder::intel;
            const int room = intel ? 8 - bit % 8 : bit % 8 + 1;
            const int width = std::min(room, length - done);
            const int shift = intel ? bit % 8 : room - width;
            const int place = intel ? done : length - done - width;
            use(static_cast<std::size_t>(bit / 8), shift, width, place);
            done += width;
            bit = bit / 8 * 8 + (intel ? 8 : 15);
        }
    }

    [[nodiscard]] constexpr double number(std::uint64_t raw) const noexcept {
        switch (encoding) {
        case Encoding::float32:
            return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
        case Encoding::float64:
            return std::bit_cast<double>(raw);
        case Encoding::signed_integer: {
            const std::uint64_t sign = std::uint64_t{1} << (length - 1);
            return static_cast<double>(std::bit_cast<std::int64_t>((raw ^ sign) - sign));
        }
        case Encoding::unsigned_integer:
            break;
        }
        return static_cast<double>(raw);
    }

    [[nodiscard]] std::uint64_t raw_of(double value) const noexcept {
        if (encoding == Encoding::float32) {
            constexpr auto highest = static_cast<double>(std::numeric_limits<float>::max());
            const double inside = std::isfinite(value) ? std::clamp(value, -highest, highest) : value;
            return std::bit_cast<std::uint32_t>(static_cast<float>(inside));
        }
        if (encoding == Encoding::float64) {
            return std::bit_cast<std::uint64_t>(value);
        }
        return std::isnan(value) ? 0 : integer_of(std::round(value));
    }

    /// Converts a rounded value to the signal's integer and clamps it. The limits are compared as powers of
    /// two, which a double represents exactly.
    [[nodiscard]] std::uint64_t integer_of(double value) const noexcept {
        if (encoding == Encoding::unsigned_integer) {
            const bool above = value >= std::ldexp(1.0, length);
            return above ? mask(length) : value <= 0 ? 0 : static_cast<std::uint64_t>(value);
        }
        const double end = std::ldexp(1.0, length - 1);
        const std::uint64_t sign = std::uint64_t{1} << (length - 1);
        const bool inside = value > -end && value < end;
        return inside ? std::bit_cast<std::uint64_t>(static_cast<std::int64_t>(value))
                      : (value > 0 ? sign - 1 : sign);
    }
};

} // namespace dfdyn::hal
