// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/damiao.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct damiao {
    static constexpr const char* dbc = "";

    static auto boards() noexcept {
        hal::DamiaoMotor::Config config{.motor_id = 5,
                                        .feedback_id = 0x15,
                                        .joint = 0,
                                        .position_max = 12.5,
                                        .velocity_max = 30,
                                        .torque_max = 10};
        const hal::DamiaoMotor first(config);
        config.motor_id = 6;
        config.feedback_id = 0x16;
        config.joint = 1;
        return std::array{first, hal::DamiaoMotor(config)};
    }
    static auto other_frames() noexcept {
        hal::Frame torque_max = hal::make_frame(0x15, 8); // register 23 of motor 5
        torque_max.data[0] = 5;
        torque_max.data[2] = 0x33;
        torque_max.data[3] = 23;
        hal::store_little(torque_max.data.data() + 4, 10.0F);
        return std::array{torque_max};
    }

    /// Feedback: state 1 (enabled) and motor id, position u16 over ±12.5 rad, velocity u12 over ±30 rad/s,
    /// torque u12 over ±10 N·m, most significant byte first; two temperatures. Register 23: the torque's
    /// range.
    struct on_wire {
        static constexpr double step_rad = 25.0 / 65535;

        static auto boards() noexcept { return damiao::boards(); }
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            return wire::one(wire::mit_feedback(board == 0 ? 0x15 : 0x16, board == 0 ? 0x15 : 0x16,
                                                joints[board], {12.5, 30, 10}, {30, 31}));
        }
        static auto status() {
            return std::array{wire::frame(0x15, {5, 0, 0x33, 23, 0, 0, 0x20, 0x41})}; // 10.0F
        }
    };
};

} // namespace dfdyn::tests::families
