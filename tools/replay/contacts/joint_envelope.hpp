// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/replay/contacts/predicted_rows.hpp"

#include "dfdyn/monitor/joint_deviation.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Deviation and motion of a joint in one tick, without limits. In the output's unit unless stated.
struct Deviation {
    std::size_t pass = 0;
    int motion = 0;
    double size = 0;                    ///< magnitude of the deviation
    double change = 0;                  ///< magnitude of the prediction's recent change
    double speed = 0, acceleration = 0; ///< rad/s, rad/s²
    double hysteresis = 0;              ///< larger end of the range of FrictionHysteresis, magnitude
    double friction = 0;                ///< with which this end explains the deviation, >= 0
    double explained = 0;               ///< width of the range with the friction in use
};

using Deviations = std::vector<Deviation>; ///< of a joint

/// Returns `value(deviation)` of those that `chosen` accepts.
template <class Value, class Chosen>
std::vector<double> values_of(const Deviations& deviations, Value value, Chosen chosen) {
    std::vector<double> values;
    for (const Deviation& one : deviations) {
        if (chosen(one)) {
            values.push_back(std::invoke(value, one));
        }
    }
    return values;
}

/// Limits of a joint that nearly all of its deviations satisfy.
struct Envelope {
    std::array<double, joint_motion_count> limit{};
    double relative = 0;

    double at(const Deviation& one) const {
        return std::hypot(limit[static_cast<std::size_t>(one.motion)], relative * one.change);
    }
};

/// Deviations of a joint, their envelope, and the friction whose hysteresis they do not contain.
struct JointEnvelope {
    Deviations deviations;
    Envelope envelope;
    double hysteresis = 0;
};

/// Returns the envelope of each joint. `least`: smallest limits, one per joint.
///
/// An envelope is the 99.9 % quantile of the deviations in each motion, or the 90 % quantile over all motions
/// if that is larger. A part is proportional to the change of the prediction. Passes with more than twice the
/// trained model's median are left out: in a short recording some blocks have motions that the others do not
/// determine. The limit at standstill is at least half the limit near a change of the motion, because
/// friction bears any torque up to the break-away torque.
///
/// Of the proportional parts and of the frictions with hysteresis, those are taken with which the smallest
/// push that is a contact has the least geometric mean. Hysteresis must reduce it by 3 %. Memory: about 100
/// bytes per row and joint. Cost: six passes of the detector and sixty sorts of the deviations.
std::vector<JointEnvelope> joint_envelopes(std::span<const PredictedRow> rows, std::span<const double> least);

} // namespace dfdyn::tools
