// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/robotous_rft.hpp"

namespace dfdyn::tests::families {

struct robotous_rft {
    static constexpr const char* dbc = "robotous_rft.dbc";

    static auto sensor() noexcept { return hal::RobotousRft(hal::RobotousRft::Config{}); }
    static auto other_frames() noexcept { return std::array<hal::Frame, 0>{}; }
};

} // namespace dfdyn::tests::families
