// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/odrive.hpp"

namespace dfdyn::tests::families {

struct odrive {
    static constexpr const char* dbc = "odrive.dbc";

    static auto boards() noexcept {
        return std::array{hal::OdriveAxis({.node = 1, .joint = 0}), hal::OdriveAxis({.node = 2, .joint = 1})};
    }
    static auto other_frames() noexcept {
        const auto axes = boards();
        return std::array{axes[0].encode_heartbeat(false), axes[1].encode_heartbeat(false)};
    }
};

} // namespace dfdyn::tests::families
