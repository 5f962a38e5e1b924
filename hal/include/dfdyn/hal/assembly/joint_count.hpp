// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/extent.hpp"

#include <array>
#include <cstddef>

namespace dfdyn::hal {

/// Largest number of joints of an arm whose number of joints is known only at run time (`dynamic`).
inline constexpr int largest_joint_count = 12;

/// Number of array elements for `n` joints: `n`, or the largest number if `n` is `dynamic`. All storage has a
/// constant size, and the host's arms need no heap either.
constexpr int places(int n) noexcept { return n == dynamic ? largest_joint_count : n; }

/// One `T` per joint. With a run-time number of joints, only the first elements are used.
template <class T, int n>
using PerJoint = std::array<T, static_cast<std::size_t>(places(n))>;

} // namespace dfdyn::hal
