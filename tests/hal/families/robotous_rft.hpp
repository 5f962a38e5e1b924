// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/robotous_rft.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct robotous_rft {
    static constexpr const char* dbc = "robotous_rft.dbc";

    static auto sensor() noexcept { return hal::RobotousRft(hal::RobotousRft::Config{}); }
    static auto other_frames() noexcept { return std::array<hal::Frame, 0>{}; }

    /// 16 bytes over two frames: 0x0B, six int16 most significant byte first, overload bits, 2 bytes.
    struct on_wire {
        static constexpr double range = 32768.0 / 50;

        static auto sensor() noexcept {
            return hal::RobotousRft({.counts_per_newton = 50, .counts_per_newton_metre = 50});
        }
        static wire::Frames frames(const wire::SixWords& raw) {
            using wire::byte_of;
            return {{wire::frame(0xF9, {0x0B, byte_of(raw[0], 1), byte_of(raw[0], 0), byte_of(raw[1], 1),
                                        byte_of(raw[1], 0), byte_of(raw[2], 1), byte_of(raw[2], 0),
                                        byte_of(raw[3], 1)}),
                     wire::frame(0xFA, {byte_of(raw[3], 0), byte_of(raw[4], 1), byte_of(raw[4], 0),
                                        byte_of(raw[5], 1), byte_of(raw[5], 0), 0, 0, 0})},
                    2};
        }
        static void saturate(hal::Frame& frame, std::size_t half) {
            frame.data[5] = half == 1 ? 0x20 : frame.data[5];
        }
    };
};

} // namespace dfdyn::tests::families
