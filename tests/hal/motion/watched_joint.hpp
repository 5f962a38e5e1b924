// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/motion.hpp"

#include <cmath>

namespace watched_joint {

using dfdyn::hal::EncoderReading;
using dfdyn::hal::MotionGate;
using dfdyn::hal::Reason;

constexpr std::int64_t period = 2'000'000;
constexpr double zero_rad = 1; ///< position where the encoder's own number is 0

inline double truth(int tick) { return 0.3 + 0.6 * std::sin(4e-3 * tick); }

/// A gate and the readings that it takes.
struct Watched {
    MotionGate gate{{.limits = {5, 20},
                     .range = {-3, 3},
                     .max_age_ns = 3 * period,
                     .period_ns = period,
                     .jitter_ns = period / 10,
                     .qualification = {.readings = 10, .zero_readings = 1000}}};

    Reason take(int tick, double position_rad) { return gate.take(reading(tick, position_rad)).reason; }

    static EncoderReading reading(int tick, double position_rad, bool zero = false) {
        return {.stamp_ns = tick * period,
                .position_rad = position_rad,
                .step_rad = 1e-5,
                .from_zero_rad = position_rad - zero_rad,
                .zero = zero};
    }

    /// Passes the readings of ticks [from, to) with this error, and returns how many were trusted.
    int trusted(int from, int to, double off_rad = 0) {
        int count = 0;
        for (int tick = from; tick < to; ++tick) {
            count += take(tick, truth(tick) + off_rad) == Reason::ok ? 1 : 0;
        }
        return count;
    }
};

} // namespace watched_joint
