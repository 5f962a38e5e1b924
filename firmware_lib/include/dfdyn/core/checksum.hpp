// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dfdyn {

namespace detail {

/// Remainder of each half byte under the reflected polynomial 0xEDB88320. The table takes 64 bytes of flash
/// and a quarter of the steps of a loop over bits.
constexpr std::array<std::uint32_t, 16> crc32_half_bytes() noexcept {
    std::array<std::uint32_t, 16> table{};
    for (std::uint32_t half = 0; half < table.size(); ++half) {
        std::uint32_t crc = half;
        for (int bit = 0; bit < 4; ++bit) {
            crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
        }
        table[half] = crc;
    }
    return table;
}

inline constexpr std::array<std::uint32_t, 16> crc32_table = crc32_half_bytes();

} // namespace detail

/// Returns the CRC-32 (ISO 3309, reflected 0xEDB88320) of `bytes`. `crc` is the checksum of the preceding
/// bytes, so that a checksum can be computed in pieces: crc32(ab) = crc32(b, crc32(a)). O(bytes).
constexpr std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t crc = 0) noexcept {
    crc = ~crc;
    for (const std::byte byte : bytes) {
        crc ^= static_cast<std::uint32_t>(byte);
        crc = (crc >> 4U) ^ detail::crc32_table[crc & 15U];
        crc = (crc >> 4U) ^ detail::crc32_table[crc & 15U];
    }
    return ~crc;
}

/// Returns the CRC-32 of the bytes of one number, in the machine's byte order.
template <class T>
std::uint32_t crc32_of(const T& number, std::uint32_t crc) noexcept {
    return crc32(std::as_bytes(std::span(&number, 1)), crc);
}

} // namespace dfdyn
