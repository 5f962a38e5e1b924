// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/icub_two_joint_board.hpp"

namespace dfdyn::tests::families {

struct icub_two_joint_board {
    static constexpr const char* dbc = "icub_two_joint_boards.dbc";

    static auto boards() noexcept {
        return std::array{hal::icub::TwoJointBoard(1, {0, -11.375, 5}, {1, 11.375, 0})};
    }
    static auto other_frames() noexcept { return std::array{boards()[0].encode_status(0, 0)}; }
};

} // namespace dfdyn::tests::families
