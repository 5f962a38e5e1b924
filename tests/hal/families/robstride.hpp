// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/robstride.hpp"

namespace dfdyn::tests::families {

struct robstride {
    static constexpr const char* dbc = "";

    static auto boards() noexcept {
        return std::array{
            hal::RobstrideMotor({.motor_id = 9, .joint = 0, .velocity_max = 33, .torque_max = 14}),
            hal::RobstrideMotor({.motor_id = 10, .joint = 1, .velocity_max = 44, .torque_max = 17})};
    }
    static auto other_frames() noexcept {
        hal::Frame no_fault = hal::make_frame(21U << 24U | 9U << 8U | 0xFDU, 8);
        no_fault.extended = true;
        return std::array{no_fault};
    }
};

} // namespace dfdyn::tests::families
