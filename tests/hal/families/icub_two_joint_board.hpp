// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/icub_two_joint_board.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct icub_two_joint_board {
    static constexpr const char* dbc = "icub_two_joint_boards.dbc";

    static auto boards() noexcept {
        return std::array{hal::icub::TwoJointBoard(1, {0, -11.375, 5}, {1, 11.375, 0})};
    }
    static auto other_frames() noexcept { return std::array{boards()[0].encode_status(0, 0)}; }

    /// POSITION 0x101 + 16 A: two int32 of ticks, least significant byte first.
    struct on_wire {
        static constexpr double ticks = 91; ///< per degree
        static constexpr double step_rad = 1 / (ticks * wire::degrees);

        static auto boards() noexcept {
            return std::array{hal::icub::TwoJointBoard(1, {0, -ticks, 20}, {1, ticks, 0})};
        }
        static wire::Frames frames(std::size_t /*board*/, const wire::Joints& joints) {
            const long long a = wire::int32((joints[0].position_rad * wire::degrees + 20) * -ticks);
            const long long b = wire::int32(joints[1].position_rad * wire::degrees * ticks);
            using wire::byte_of;
            return wire::one(
                wire::frame(0x111, {byte_of(a, 0), byte_of(a, 1), byte_of(a, 2), byte_of(a, 3), byte_of(b, 0),
                                    byte_of(b, 1), byte_of(b, 2), byte_of(b, 3)}));
        }
    };
};

} // namespace dfdyn::tests::families
