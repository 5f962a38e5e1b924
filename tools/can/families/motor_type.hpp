// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace dfdyn::tools {

/// Maxima of a motor's codes: position (rad), velocity (rad/s), torque (N·m).
using Maxima = std::array<double, 3>;

/// A motor type with its factory maxima from one widely used library or document, and from another one if
/// they disagree. Then only the motor itself is reliable.
struct MotorType {
    std::string_view name;
    Maxima maxima;
    Maxima others = maxima;

    bool agrees(std::size_t i) const noexcept { return maxima[i] == others[i]; }
};

} // namespace dfdyn::tools
