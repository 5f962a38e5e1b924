// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/icub_strain.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct icub_strain {
    static constexpr const char* dbc = "icub_strain.dbc";

    static auto sensor() noexcept { return hal::icub::StrainBoard(0x0D); }
    static auto other_frames() noexcept {
        std::array<hal::Frame, 6> full_scales;
        for (int channel = 0; channel < 6; ++channel) {
            full_scales[static_cast<std::size_t>(channel)] =
                sensor().encode_full_scale(channel, channel < 3 ? 300 : 10);
        }
        return full_scales;
    }

    /// 0x30A + 16 A force, 0x30B + 16 A torque: u16, offset 0x8000, least significant byte first; a seventh
    /// byte while it is saturated. Answer to 0x18: 0x200 + 16 A: 0x18, channel, full scale u16.
    struct on_wire {
        static constexpr double range = 500; ///< N or N·m at 32768 counts

        static wire::Frames frames(const wire::SixWords& raw) {
            const auto half = [&](unsigned id, std::size_t from) {
                using wire::byte_of;
                return wire::frame(id,
                                   {byte_of(raw[from] + 0x8000, 0), byte_of(raw[from] + 0x8000, 1),
                                    byte_of(raw[from + 1] + 0x8000, 0), byte_of(raw[from + 1] + 0x8000, 1),
                                    byte_of(raw[from + 2] + 0x8000, 0), byte_of(raw[from + 2] + 0x8000, 1)});
            };
            return {{half(0x3DA, 0), half(0x3DB, 3)}, 2};
        }
        static void saturate(hal::Frame& frame, std::size_t /*half*/) {
            frame.length = 7;
            frame.data[6] = 0x0A;
        }
        static auto status() {
            std::array<hal::Frame, 6> full_scales;
            for (unsigned channel = 0; channel < 6; ++channel) {
                full_scales[channel] = wire::frame(0x2D0, {0x18, channel, 500 >> 8U, 500});
            }
            return full_scales;
        }
    };
};

} // namespace dfdyn::tests::families
