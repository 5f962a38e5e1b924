// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/extent.hpp"

#include <cstdint>

namespace dfdyn {

/// Alignment of the arrays of a state in bytes, for vector loads.
inline constexpr int storage_alignment = 32;

/// Returns the bytes of `count` numbers in place, including alignment. The `state_bytes` of maps and learners
/// are sums of these. An object needs additional pointers and indices, whose size does not depend on the
/// model's sizes.
template <class T>
constexpr std::int64_t storage_bytes(std::int64_t count) noexcept {
    const std::int64_t bytes = count * static_cast<std::int64_t>(sizeof(T));
    return (bytes + storage_alignment - 1) / storage_alignment * storage_alignment;
}

/// `count` numbers in place, aligned for vector loads. An aggregate, so that a table of constants can be in
/// flash. Unlike Eigen's fixed-size matrices it is not limited to 128 KB.
template <class T, int count>
struct Storage {
    static_assert(count > 0);
    alignas(T) alignas(storage_alignment) T values[count]; ///< the numbers

    /// Returns `count` zeros.
    static constexpr Storage zeros(Extent<count> /*size*/) noexcept { return Storage{}; }

    /// Returns `count`.
    [[nodiscard]] static constexpr int size() noexcept { return count; }
    [[nodiscard]] constexpr T* data() noexcept { return values; }             ///< Returns the first number.
    [[nodiscard]] constexpr const T* data() const noexcept { return values; } ///< Returns the first number.
    /// Returns a number, 0 ≤ index < count; not checked.
    constexpr T& operator[](int index) noexcept { return values[index]; }
    /// Returns a number, 0 ≤ index < count; not checked.
    constexpr const T& operator[](int index) const noexcept { return values[index]; }
    [[nodiscard]] constexpr T* begin() noexcept { return values; }                   ///< Begin of the range.
    [[nodiscard]] constexpr T* end() noexcept { return values + count; }             ///< End of the range.
    [[nodiscard]] constexpr const T* begin() const noexcept { return values; }       ///< Begin of the range.
    [[nodiscard]] constexpr const T* end() const noexcept { return values + count; } ///< End of the range.
};

/// The host's tools specialise this for sizes that are known only at run time.
template <class T>
struct Storage<T, dynamic>;

} // namespace dfdyn
