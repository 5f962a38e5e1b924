// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/extent.hpp"

#include <cstdint>

namespace dfdyn {

/// Where the arrays of a state begin, for vector loads.
inline constexpr int storage_alignment = 32;

/// The bytes that `count` numbers take in place. The `state_bytes` of the maps and learners are sums of
/// these, functions of the sizes: what an object takes beyond them, pointers and indices, is the same
/// whatever the sizes.
template <class T>
constexpr std::int64_t storage_bytes(std::int64_t count) noexcept {
    const std::int64_t bytes = count * static_cast<std::int64_t>(sizeof(T));
    return (bytes + storage_alignment - 1) / storage_alignment * storage_alignment;
}

/// `count` numbers in place, aligned for vector loads. An aggregate, so that a table of constants can live in
/// flash. Eigen's fixed-size matrices are limited to 128 KB; this is not.
template <class T, int count>
struct Storage {
    static_assert(count > 0);
    alignas(storage_alignment) T values[count];

    static constexpr Storage zeros(Extent<count> /*size*/) noexcept { return Storage{}; }

    [[nodiscard]] static constexpr int size() noexcept { return count; }
    [[nodiscard]] constexpr T* data() noexcept { return values; }
    [[nodiscard]] constexpr const T* data() const noexcept { return values; }
    constexpr T& operator[](int index) noexcept { return values[index]; }
    constexpr const T& operator[](int index) const noexcept { return values[index]; }
    [[nodiscard]] constexpr T* begin() noexcept { return values; }
    [[nodiscard]] constexpr T* end() noexcept { return values + count; }
    [[nodiscard]] constexpr const T* begin() const noexcept { return values; }
    [[nodiscard]] constexpr const T* end() const noexcept { return values + count; }
};

/// The host's tools specialise this for sizes that are known at run time only.
template <class T>
struct Storage<T, dynamic>;

} // namespace dfdyn
