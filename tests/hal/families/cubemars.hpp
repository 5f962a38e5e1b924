// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/cubemars.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

/// CubeMars motors in servo mode.
struct cubemars {
    static constexpr const char* dbc = "cubemars.dbc";

    static auto boards() noexcept {
        return std::array{hal::CubemarsServo({.motor_id = 1, .packet = 0x29, .joint = 0}),
                          hal::CubemarsServo({.motor_id = 2, .packet = 0x29, .joint = 1})};
    }
    static auto other_frames() noexcept { return std::array<hal::Frame, 0>{}; }

    /// Packet 0x29 on 29 bits: position i16 (0.1 °), speed i16 (10 electrical revolutions per minute),
    /// current i16 (0.01 A), most significant byte first; temperature, error. 21 pole pairs, gear of 9.
    struct on_wire {
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            const wire::Joint& joint = joints[board];
            const long long q = wire::int16(joint.position_rad * wire::degrees / 0.1);
            const long long v = wire::int16(joint.velocity / wire::turn * 60 * 21 * 9 / 10);
            const long long i = wire::int16(joint.effort / 0.01);
            using wire::byte_of;
            hal::Frame frame = wire::frame(0x2900U + static_cast<unsigned>(1 + board),
                                           {byte_of(q, 1), byte_of(q, 0), byte_of(v, 1), byte_of(v, 0),
                                            byte_of(i, 1), byte_of(i, 0), 25, 0});
            frame.extended = true;
            return wire::one(frame);
        }
    };
};

} // namespace dfdyn::tests::families
