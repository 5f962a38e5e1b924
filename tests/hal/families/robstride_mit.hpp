// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/robstride.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

/// Robstride motors in MIT mode, which answer on one identifier.
struct robstride_mit {
    static constexpr const char* dbc = "";

    static auto boards() noexcept {
        hal::RobstrideMitMotor::Config config{.motor_id = 1,
                                              .feedback_id = 0xFD,
                                              .joint = 0,
                                              .position_max = 12.57,
                                              .velocity_max = 33,
                                              .torque_max = 14,
                                              .shared_feedback_id = true};
        const hal::RobstrideMitMotor first(config);
        config.motor_id = 2;
        config.joint = 1;
        return std::array{first, hal::RobstrideMitMotor(config)};
    }
    static auto other_frames() noexcept { return std::array<hal::Frame, 0>{}; }

    struct on_wire {
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            return wire::one(wire::mit_feedback(0xFD, static_cast<unsigned>(1 + board), joints[board],
                                                {12.57, 33, 14}, {0, 250}));
        }
    };
};

} // namespace dfdyn::tests::families
