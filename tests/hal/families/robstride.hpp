// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/robstride.hpp"
#include "tests/hal/support/wire.hpp"

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

    /// Type 2 on 29 bits, mode run, motor, host 0xFD: angle in ±4π, velocity and torque in their ranges,
    /// temperature (0.1 °C), u16, most significant byte first.
    struct on_wire {
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            const wire::Joint& joint = joints[board];
            const long long q = wire::linear_code(joint.position_rad, 2 * wire::turn, 16);
            const long long v = wire::linear_code(joint.velocity, board == 0 ? 33 : 44, 16);
            const long long t = wire::linear_code(joint.effort, board == 0 ? 14 : 17, 16);
            using wire::byte_of;
            hal::Frame frame = wire::frame(0x028000FDU | static_cast<unsigned>(9 + board) << 8U,
                                           {byte_of(q, 1), byte_of(q, 0), byte_of(v, 1), byte_of(v, 0),
                                            byte_of(t, 1), byte_of(t, 0), 0, 250});
            frame.extended = true;
            return wire::one(frame);
        }
    };
};

} // namespace dfdyn::tests::families
