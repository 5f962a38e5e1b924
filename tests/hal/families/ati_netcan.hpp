// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/ati_netcan.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct ati_netcan {
    static constexpr const char* dbc = "ati_netcan.dbc";

    static auto sensor() noexcept {
        hal::AtiNetcan::Config config;
        for (std::size_t i = 0; i < 6; ++i) {
            config.matrix[i][i] = 1;
            config.matrix[i][(i + 1) % 6] = 0.25;
        }
        config.counts_per_newton = 100;
        config.counts_per_newton_metre = 5000;
        return hal::AtiNetcan(config);
    }
    static auto other_frames() noexcept { return std::array<hal::Frame, 0>{}; }

    /// 16 B: status u16 and gauges 0, 2, 4; 16 B + 1: gauges 1, 3, 5; int16, most significant byte first. The
    /// matrix of this sensor gives each axis one gauge.
    struct on_wire {
        static constexpr double range = 32768.0 / 64;

        static auto sensor() noexcept {
            hal::AtiNetcan::Config config;
            for (std::size_t i = 0; i < 6; ++i) {
                config.matrix[i][i] = 1;
            }
            config.counts_per_newton = config.counts_per_newton_metre = 64;
            return hal::AtiNetcan(config);
        }
        static wire::Frames frames(const wire::SixWords& raw) {
            using wire::byte_of;
            return {{wire::frame(0x200, {0, 0, byte_of(raw[0], 1), byte_of(raw[0], 0), byte_of(raw[2], 1),
                                         byte_of(raw[2], 0), byte_of(raw[4], 1), byte_of(raw[4], 0)}),
                     wire::frame(0x201, {byte_of(raw[1], 1), byte_of(raw[1], 0), byte_of(raw[3], 1),
                                         byte_of(raw[3], 0), byte_of(raw[5], 1), byte_of(raw[5], 0)})},
                    2};
        }
        static void saturate(hal::Frame& frame, std::size_t half) {
            if (half == 0) {
                frame.data[2] = 0x7F;
                frame.data[3] = 0xFF;
            }
        }
    };
};

} // namespace dfdyn::tests::families
