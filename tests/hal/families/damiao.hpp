// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/damiao.hpp"

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
};

} // namespace dfdyn::tests::families
