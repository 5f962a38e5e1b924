// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/storage.hpp"

#include <cstdint>

namespace dfdyn {

/// What may have changed. The numbers are stable.
enum class Cause : std::uint8_t {
    unknown = 0,  ///< something, but none of the others
    payload = 1,  ///< attached at the tool, or taken off
    friction = 2, ///< of a joint
    bias = 3,     ///< of an output: an offset that moved
    contact = 4,  ///< a force on the arm, which ends
    frozen = 5,   ///< a sensor repeats itself
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

/// A change, and what fits it best.
template <class Scalar, int m>
struct Change {
    std::int64_t onset_ns = 0; ///< estimated
    std::int64_t alarm_ns = 0;
    std::int64_t end_ns = 0; ///< when it was learned or went away; 0: not yet
    int channel = 0; ///< the output that raised the alarm; m: all together; -1: a reading that repeats

    Cause cause = Cause::unknown;
    Cause runner_up = Cause::unknown;
    Scalar confidence = 0, runner_up_confidence = 0; ///< 0 … 1; those of all causes add up to 1

    /// Friction: the joint. Bias: the output where it is largest in units of the noise. Contact: the output
    /// that it acts on most, or -1 where a force at the tool fits better. Frozen: the joint's position, or
    /// joints + the output. Otherwise -1.
    int where = -1;
    /// Payload: mass (kg) and first moment (kg·m, 3) about the tip in the last link's frame. Friction:
    /// Coulomb (N·m) and viscous (N·m·s/rad). Contact: mean of the force on the tool (N, 3, base frame), or
    /// of the joint's torque.
    Scalar size[4] = {};
    Storage<Scalar, m> bias; ///< by how much each offset moved, in the outputs' units; bias only
};

} // namespace dfdyn
