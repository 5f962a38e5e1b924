// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/piper.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct piper {
    static constexpr const char* dbc = "piper.dbc";

    static auto boards() noexcept { return std::array{hal::PiperPair(hal::PiperPair::Config{})}; }
    static auto other_frames() noexcept {
        hal::Frame enabled = hal::make_frame(0x261, 8);
        enabled.data[5] = 0x40;
        return std::array{enabled, hal::make_frame(0x2A1, 8)};
    }

    /// 0x2A5, angles of joints 1 and 2, i32 (0.001 °); 0x251 and 0x252, speed i16 (0.001 rad/s), current i16
    /// (0.001 A), position i32: most significant byte first.
    struct on_wire {
        static wire::Frames frames(std::size_t /*board*/, const wire::Joints& joints) {
            using wire::byte_of;
            const auto angle = [&](std::size_t i) {
                return wire::int32(joints[i].position_rad * wire::degrees / 0.001);
            };
            const auto fast = [&](unsigned id, const wire::Joint& joint) {
                const long long v = wire::int16(joint.velocity / 0.001);
                const long long i = wire::int16(joint.effort / 0.001);
                return wire::frame(id,
                                   {byte_of(v, 1), byte_of(v, 0), byte_of(i, 1), byte_of(i, 0), 0, 0, 0, 0});
            };
            const long long a = angle(0);
            const long long b = angle(1);
            return {{wire::frame(0x2A5, {byte_of(a, 3), byte_of(a, 2), byte_of(a, 1), byte_of(a, 0),
                                         byte_of(b, 3), byte_of(b, 2), byte_of(b, 1), byte_of(b, 0)}),
                     fast(0x251, joints[0]), fast(0x252, joints[1])},
                    3};
        }
    };
};

} // namespace dfdyn::tests::families
