// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/rmd.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct rmd {
    static constexpr const char* dbc = "rmd.dbc";

    static auto boards() noexcept {
        return std::array{hal::RmdMotor({.motor_id = 1, .joint = 0}),
                          hal::RmdMotor({.motor_id = 2, .joint = 1})};
    }
    static auto other_frames() noexcept {
        hal::Frame no_error = hal::make_frame(0x241, 8);
        no_error.data[0] = 0x9A;
        return std::array{no_error};
    }

    /// Answers on 0x240 + motor, least significant byte first: 0x92, angle i32 (0.01 °) at byte 4; 0x9C,
    /// temperature, current i16 (0.01 A), speed i16 (°/s), angle i16 (°).
    struct on_wire {
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            const unsigned id = 0x241U + static_cast<unsigned>(board);
            const wire::Joint& joint = joints[board];
            const long long q = wire::int32(joint.position_rad * wire::degrees / 0.01);
            const long long i = wire::int16(joint.effort / 0.01);
            const long long v = wire::int16(joint.velocity * wire::degrees);
            const long long coarse = wire::int16(joint.position_rad * wire::degrees);
            using wire::byte_of;
            return {
                {wire::frame(id, {0x92, 0, 0, 0, byte_of(q, 0), byte_of(q, 1), byte_of(q, 2), byte_of(q, 3)}),
                 wire::frame(id, {0x9C, 25, byte_of(i, 0), byte_of(i, 1), byte_of(v, 0), byte_of(v, 1),
                                  byte_of(coarse, 0), byte_of(coarse, 1)})},
                2};
        }
    };
};

} // namespace dfdyn::tests::families
