// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/icub_2foc.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct icub_2foc {
    static constexpr const char* dbc = "icub_2foc.dbc";

    static auto boards() noexcept {
        return std::array{hal::icub::FocBoard({.address = 3, .joint = 0}),
                          hal::icub::FocBoard({.address = 4, .joint = 1})};
    }
    static auto other_frames() noexcept { return std::array{boards()[0].encode_status(0, 0)}; }

    /// 0x100 + 16 A: current int16 (mA), velocity int16, position int32 (1/65536 turn of the motor), least
    /// significant byte first. The motors turn twice for a turn of the joint, one of them backward.
    struct on_wire {
        static constexpr double step_rad = wire::turn / 65536 / 2;

        static auto boards() noexcept {
            return std::array{
                hal::icub::FocBoard({.address = 3, .joint = 0, .motor_per_joint = 2}),
                hal::icub::FocBoard({.address = 4, .joint = 1, .motor_per_joint = -2, .zero_rad = 0.4})};
        }
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            const wire::Joint& joint = joints[board];
            const double turns = board == 0 ? 2 * joint.position_rad / wire::turn
                                            : -2 * (joint.position_rad - 0.4) / wire::turn;
            const long long i = wire::int16(1000 * joint.effort);
            const long long q = wire::int32(65536 * turns);
            using wire::byte_of;
            return wire::one(wire::frame(board == 0 ? 0x130 : 0x140,
                                         {byte_of(i, 0), byte_of(i, 1), 0x12, 0x34, byte_of(q, 0),
                                          byte_of(q, 1), byte_of(q, 2), byte_of(q, 3)}));
        }
    };
};

} // namespace dfdyn::tests::families
