// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/cubemars.hpp"

namespace dfdyn::tests::families {

/// CubeMars motors in servo mode.
struct cubemars {
    static constexpr const char* dbc = "cubemars.dbc";

    static auto boards() noexcept {
        return std::array{hal::CubemarsServo({.motor_id = 1, .packet = 0x29, .joint = 0}),
                          hal::CubemarsServo({.motor_id = 2, .packet = 0x29, .joint = 1})};
    }
    static auto other_frames() noexcept { return std::array<hal::Frame, 0>{}; }
};

} // namespace dfdyn::tests::families
