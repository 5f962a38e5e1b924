// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/odrive.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct odrive {
    static constexpr const char* dbc = "odrive.dbc";

    static auto boards() noexcept {
        return std::array{hal::OdriveAxis({.node = 1, .joint = 0}), hal::OdriveAxis({.node = 2, .joint = 1})};
    }
    static auto other_frames() noexcept {
        const auto axes = boards();
        return std::array{axes[0].encode_heartbeat(false), axes[1].encode_heartbeat(false)};
    }

    /// 32 N + 0x09: position (turns), velocity (turns/s), float; 32 N + 0x01, heartbeat: error u32, state,
    /// three flags. The second motor turns eight times backward for a turn of the joint.
    struct on_wire {
        static constexpr double step_rad = 2e-6; ///< of a float, at most

        static auto boards() noexcept {
            return std::array{hal::OdriveAxis({.node = 1, .joint = 0}),
                              hal::OdriveAxis({.node = 2, .joint = 1, .motor_per_joint = -8})};
        }
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            const double ratio = (board == 0 ? 1 : -8) / wire::turn;
            const std::array<float, 2> values{static_cast<float>(ratio * joints[board].position_rad),
                                              static_cast<float>(ratio * joints[board].velocity)};
            hal::Frame frame = wire::frame(board == 0 ? 0x29 : 0x49, {0, 0, 0, 0, 0, 0, 0, 0});
            std::memcpy(frame.data.data(), values.data(), 8); // the test machine is little-endian
            return wire::one(frame);
        }
        static auto status() {
            return std::array{wire::frame(0x21, {0, 0, 0, 0, 8, 0, 0, 0}),
                              wire::frame(0x41, {0, 0, 0, 0, 8, 0, 0, 0})};
        }
    };
};

} // namespace dfdyn::tests::families
