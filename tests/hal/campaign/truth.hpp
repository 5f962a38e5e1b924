// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/encoder_reading.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

namespace dfdyn::tests {

/// Motion of the campaign's arm: two joints in smooth motion, their efforts, and a wrench. The wrench changes
/// so fast that a value from another period is detectable.
struct Truth {
    static constexpr int joints = 2;

    explicit Truth(std::mt19937_64& engine) {
        std::uniform_real_distribution<double> unit(0, 1);
        for (std::size_t i = 0; i < 2; ++i) {
            slow[i] = 0.8 + 0.8 * unit(engine);
            fast[i] = 4 + 2 * unit(engine);
            phase[i] = 6 * unit(engine);
            centre[i] = -0.6 + 1.2 * unit(engine);
        }
    }

    /// Returns position (rad), velocity and acceleration of a joint.
    [[nodiscard]] double position(std::size_t i, double t) const {
        return centre[i] + 1.1 * std::sin(slow[i] * t + phase[i]) + 0.15 * std::sin(fast[i] * t);
    }
    [[nodiscard]] double velocity(std::size_t i, double t) const {
        return 1.1 * slow[i] * std::cos(slow[i] * t + phase[i]) + 0.15 * fast[i] * std::cos(fast[i] * t);
    }
    static constexpr double most_velocity = 1.1 * 1.6 + 0.15 * 6;            // rad/s
    static constexpr double most_acceleration = 1.1 * 1.6 * 1.6 + 0.15 * 36; // rad/s²

    /// Returns an effort (N·m or A), at most 8; changes by at most 120 per second.
    [[nodiscard]] double effort(std::size_t i, double t) const {
        return 6 * std::sin(20 * t + phase[i]) + 2 * position(i, t) / 2;
    }
    static constexpr double effort_bend = 6 * 20 * 20 + most_acceleration; ///< largest second derivative

    /// Returns a fraction of the sensor's range, per channel; changes by at most 3 per second.
    [[nodiscard]] double load(std::size_t channel, double t) const {
        return 0.15 * std::sin(20 * t + static_cast<double>(channel) + phase[0]) + 0.02;
    }
    static constexpr double load_rate = 0.15 * 20;
    static constexpr double load_bend = 0.15 * 20 * 20;

    std::array<double, 2> slow{}, fast{}, phase{}, centre{};
};

using hal::seconds_of;

} // namespace dfdyn::tests
