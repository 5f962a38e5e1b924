// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"

#include <cstdint>

namespace dfdyn {

/// Possible causes of a change. The numbers are stable.
enum class Cause : std::uint8_t {
    unknown = 0,  ///< a change that none of the others explains
    payload = 1,  ///< attached at the tool, or taken off
    friction = 2, ///< of a joint
    bias = 3,     ///< of an output: an offset that moved
    contact = 4,  ///< a temporary force on the arm
    frozen = 5,   ///< a sensor that repeats one reading
};

inline constexpr int cause_count = 6;

constexpr const char* name(Cause cause) noexcept {
    switch (cause) {
    case Cause::unknown:
        return "unknown";
    case Cause::payload:
        return "payload";
    case Cause::friction:
        return "friction_changed";
    case Cause::bias:
        return "bias_moved";
    case Cause::contact:
        return "external_contact";
    case Cause::frozen:
        return "sensor_frozen";
    }
    return "unknown";
}

/// A change with its most probable cause.
template <class Scalar, int m>
struct Change {
    std::int64_t onset_ns = 0; ///< estimated
    std::int64_t alarm_ns = 0; ///< stamp of the sample at which it was detected
    std::int64_t end_ns = 0;   ///< when it was learned or had passed; 0: not yet
    int channel = 0;           ///< output that raised the alarm; m: all together; -1: a repeated reading

    Cause cause = Cause::unknown;     ///< the most probable
    Cause runner_up = Cause::unknown; ///< the second
    Scalar confidence = 0;            ///< of `cause`, 0 … 1; over all causes they sum to 1
    Scalar runner_up_confidence = 0;  ///< of `runner_up`

    /// Index of the place, or -1:
    /// - friction: joint;
    /// - bias: output with the largest ratio of bias to noise;
    /// - contact: output with the largest torque, -1 if a force at the tool fits better;
    /// - frozen: joint of the position sensor, or number of joints + output.
    int where = -1;
    /// Parameters of the cause:
    /// - payload: mass (kg), first moment about the tip in the last link's frame (kg·m, 3 values);
    /// - friction: additional Coulomb (N·m) and viscous friction (N·m·s/rad);
    /// - contact: mean force on the tool in the base frame (N, 3 values), or mean torque of the joint (N·m).
    Scalar size[4] = {};
    Storage<Scalar, m> bias; ///< change of each offset, in output units; bias only
};

} // namespace dfdyn
