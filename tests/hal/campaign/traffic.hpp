// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"
#include "dfdyn/hal/motion/motion_line.hpp"
#include "tests/hal/campaign/truth.hpp"
#include "tests/hal/support/wire.hpp"

#include <random>
#include <vector>

namespace dfdyn::tests {

/// Times of the campaign's buses.
constexpr std::int64_t bus_us = 1000;
constexpr std::int64_t bus_period = 2000 * bus_us;
constexpr std::int64_t bus_jitter = 200 * bus_us; ///< from a measurement to its frame, at most
constexpr std::int64_t bus_track_jitter = bus_jitter + 50 * bus_us; ///< value in the description
constexpr std::int64_t bus_max_age = 3 * bus_period;
constexpr std::int64_t answer_ns = 600 * bus_us; ///< largest time from a SYNC to its answers
constexpr std::int64_t timer_delay = 3 * bus_period / 2;

/// Joint limits in the robot's file: twice the true ones.
constexpr hal::MotionLimits own_limits{2 * Truth::most_velocity, 2 * Truth::most_acceleration};

/// A frame and its origin.
struct Sent {
    enum class Role { sync, joints, wrench, status, noise };
    hal::Frame frame;
    std::int64_t true_ns = 0; ///< time of transmission
    Role role = Role::noise;
    std::size_t unit = 0; ///< board, from 0
    std::size_t part = 0; ///< index of the frame of the board or of the wrench, from 0
    int cycle = 0;
    wire::Joints shown{};       ///< values in a joint's frame
    std::int64_t clock_ns = 0;  ///< error of the stamps' clock
    bool corrupted = false;     ///< one bit of its data is flipped
    bool other_form = false;    ///< a gateway changed its frame type
    bool uninformative = false; ///< its position is repeated, or not known yet
    bool other_sender = false;  ///< from a second sender, with a different encoder
};
using Traffic = std::vector<Sent>;

/// Constants of a run.
struct Scene {
    Truth truth;
    std::int64_t start_ns = 0;
    std::mt19937_64* engine = nullptr;

    [[nodiscard]] double noise(double counts) const {
        return std::uniform_real_distribution<double>(-counts, counts)(*engine);
    }
    [[nodiscard]] std::int64_t jitter() const {
        return std::uniform_int_distribution<std::int64_t>(0, bus_jitter)(*engine);
    }
    [[nodiscard]] std::int64_t cycle_ns(int cycle) const { return start_ns + cycle * bus_period; }
};

} // namespace dfdyn::tests
