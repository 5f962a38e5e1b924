// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/extent.hpp"

namespace dfdyn {

/// `count` numbers in place, aligned for vector loads. An aggregate, so that a table of constants can live in
/// flash. Eigen's fixed-size matrices are limited to 128 KB; this is not.
template <class T, int count>
struct Storage {
    static_assert(count > 0);
    alignas(32) T values[count];

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
