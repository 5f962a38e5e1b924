// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/cubemars.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

/// CubeMars motors in MIT mode, which answer on one identifier.
struct cubemars_mit {
    static constexpr const char* dbc = "";

    static auto boards() noexcept {
        hal::CubemarsMitMotor::Config config{.motor_id = 3,
                                             .feedback_id = 0,
                                             .joint = 0,
                                             .position_max = 12.5,
                                             .velocity_max = 50,
                                             .torque_max = 18,
                                             .shared_feedback_id = true};
        const hal::CubemarsMitMotor first(config);
        config.motor_id = 4;
        config.joint = 1;
        return std::array{first, hal::CubemarsMitMotor(config)};
    }
    static auto other_frames() noexcept { return std::array<hal::Frame, 0>{}; }

    struct on_wire {
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            return wire::one(wire::mit_feedback(0, static_cast<unsigned>(3 + board), joints[board],
                                                {12.5, 50, 18}, {25, 0}));
        }
    };
};

} // namespace dfdyn::tests::families
