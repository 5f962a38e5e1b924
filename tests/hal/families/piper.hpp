// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/piper.hpp"

namespace dfdyn::tests::families {

struct piper {
    static constexpr const char* dbc = "piper.dbc";

    static auto boards() noexcept { return std::array{hal::PiperPair(hal::PiperPair::Config{})}; }
    static auto other_frames() noexcept {
        hal::Frame enabled = hal::make_frame(0x261, 8);
        enabled.data[5] = 0x40;
        return std::array{enabled, hal::make_frame(0x2A1, 8)};
    }
};

} // namespace dfdyn::tests::families
