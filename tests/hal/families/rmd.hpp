// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/rmd.hpp"

namespace dfdyn::tests::families {

struct rmd {
    static constexpr const char* dbc = "rmd.dbc";

    static auto boards() noexcept {
        return std::array{hal::RmdMotor({.motor_id = 1, .joint = 0}),
                          hal::RmdMotor({.motor_id = 2, .joint = 1})};
    }
    static auto other_frames() noexcept {
        hal::Frame no_error = hal::make_frame(0x241, 8);
        no_error.data[0] = 0x9A;
        return std::array{no_error};
    }
};

} // namespace dfdyn::tests::families
