// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/moteus.hpp"

namespace dfdyn::tests::families {

struct moteus {
    static constexpr const char* dbc = "";

    static auto boards() noexcept {
        return std::array{hal::MoteusController({.id = 5, .joint = 0}),
                          hal::MoteusController({.id = 12, .joint = 1})};
    }
    static auto other_frames() noexcept {
        hal::Frame mode = hal::make_frame(0x500, 3); // int8, register 0: mode position
        mode.fd = true;
        mode.data = {0x21, 0x00, 10};
        return std::array{mode};
    }
};

} // namespace dfdyn::tests::families
