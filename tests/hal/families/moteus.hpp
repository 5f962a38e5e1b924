// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/moteus.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct moteus {
    static constexpr const char* dbc = "";

    static auto boards() noexcept {
        return std::array{hal::MoteusController({.id = 5, .joint = 0}),
                          hal::MoteusController({.id = 12, .joint = 1})};
    }
    static auto other_frames() noexcept {
        hal::Frame mode = hal::make_frame(0x500, 3); // int8, register 0: mode position
        mode.fd = true;
        mode.data = {0x21, 0x00, 10};
        return std::array{mode};
    }

    /// Reply on 29 bits, CAN FD, least significant byte first: int8 of register 0, mode; three floats from
    /// register 1 on: position (turns), velocity (turns/s), torque (N·m); int8 of register 15, fault.
    struct on_wire {
        static constexpr double step_rad = 2e-6; ///< of a float, at most

        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            const wire::Joint& joint = joints[board];
            const std::array<float, 3> values{static_cast<float>(joint.position_rad / wire::turn),
                                              static_cast<float>(joint.velocity / wire::turn),
                                              static_cast<float>(joint.effort)};
            hal::Frame frame = wire::frame(board == 0 ? 0x500 : 0xC00, {0x21, 0x00, 10, 0x2F, 0x01});
            std::memcpy(frame.data.data() + 5, values.data(), 12); // the test machine is little-endian
            frame.data[17] = 0x21;
            frame.data[18] = 0x0F;
            frame.length = 20;
            frame.fd = true;
            frame.extended = board == 1; // more than 11 bits
            return wire::one(frame);
        }
    };
};

} // namespace dfdyn::tests::families
