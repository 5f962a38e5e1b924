// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/icub_2foc.hpp"

namespace dfdyn::tests::families {

struct icub_2foc {
    static constexpr const char* dbc = "icub_2foc.dbc";

    static auto boards() noexcept {
        return std::array{hal::icub::FocBoard({.address = 3, .joint = 0}),
                          hal::icub::FocBoard({.address = 4, .joint = 1})};
    }
    static auto other_frames() noexcept { return std::array{boards()[0].encode_status(0, 0)}; }
};

} // namespace dfdyn::tests::families
