// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace dfdyn::tests {

/// Properties of a correct recording.
struct RunKind {
    tools::OutputKind outputs = tools::OutputKind::joint_torque;
    double speed = 1;              ///< approximate speed of the joints, rad/s
    double rate_hz = 100;          ///< rows per second
    std::vector<bool> moving = {}; ///< whether each joint moves; empty if all do
    double payload_kg = 0;         ///< at up to 0.2 m from the tip in a random direction
    double friction = 0;          ///< Coulomb friction relative to the largest rigid-body torque of the joint
    double noise = 0;             ///< of the outputs, relative to their standard deviation
    double position_noise = 1e-5; ///< standard deviation, rad
    double duration_s = 30;
    double rest_s = 0; ///< above 0: moves from posture to posture, with so much rest in between
    int postures = 0;  ///< that these moves visit in turn; 0: a new one each

    std::string describe() const;
};

/// Multisine motion, or moves with rests, of a rigid body with payload, friction and noise; the robot's file
/// lacks the payload. The friction of a joint at rest holds a random torque of at most 1.3 times its level,
/// in about half of the rests in the direction of the last move, as behind a position controller. Currents
/// have a random torque constant per joint of 0.5 to 20 N·m/A. Equal arguments and engines give equal
/// recordings.
tools::Recording simulated_run(const tools::Robot& robot, const RunKind& kind, std::mt19937_64& engine);

/// A random run for a robot: slow or fast, 40 Hz to 1 kHz, some joints at rest, with and without rests,
/// payload, friction and noise.
RunKind random_kind(const tools::Robot& robot, tools::OutputKind outputs, std::mt19937_64& engine);

} // namespace dfdyn::tests
