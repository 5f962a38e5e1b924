// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn {

/// Storage of a size that is known at run time only. With it, the host's tools run models of any size with
/// the firmware's code.
template <class T>
struct Storage<T, dynamic> {
    std::vector<T, Eigen::aligned_allocator<T>> values;

    static Storage zeros(Extent<dynamic> size) {
        return {{std::vector<T, Eigen::aligned_allocator<T>>(static_cast<std::size_t>(size.value))}};
    }

    [[nodiscard]] int size() const noexcept { return static_cast<int>(values.size()); }
    [[nodiscard]] T* data() noexcept { return values.data(); }
    [[nodiscard]] const T* data() const noexcept { return values.data(); }
    T& operator[](int index) noexcept { return values[static_cast<std::size_t>(index)]; }
    const T& operator[](int index) const noexcept { return values[static_cast<std::size_t>(index)]; }
    [[nodiscard]] T* begin() noexcept { return data(); }
    [[nodiscard]] T* end() noexcept { return data() + size(); }
    [[nodiscard]] const T* begin() const noexcept { return data(); }
    [[nodiscard]] const T* end() const noexcept { return data() + size(); }
};

} // namespace dfdyn
