// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace dfdyn::tests {

/// How a recording that is right was made.
struct RunKind {
    tools::OutputKind outputs = tools::OutputKind::joint_torque;
    double speed = 1;              ///< rad/s, about
    double rate_hz = 100;          ///< of the rows
    std::vector<bool> moving = {}; ///< which joints move; empty: all
    double payload_kg = 0;         ///< at the tip, up to 0.2 m from it in any direction
    double friction = 0;           ///< Coulomb friction over the largest rigid torque of the joint
    double noise = 0;              ///< of the outputs, over their deviation
    double position_noise = 1e-5;  ///< rad
    double duration_s = 30;

    std::string describe() const;
};

/// Multisine motion of a rigid body with payload, friction and noise; the robot's file does not know the
/// payload. Currents have a random torque constant per joint, 0.5 to 20 N·m/A. Everything is determined by
/// the arguments and the engine.
tools::Recording simulated_run(const tools::Robot& robot, const RunKind& kind, std::mt19937_64& engine);

/// A random kind of run for a robot: slow or fast, 40 Hz to 1 kHz, with joints that stand, payloads, with and
/// without friction and noise.
RunKind random_kind(const tools::Robot& robot, tools::OutputKind outputs, std::mt19937_64& engine);

} // namespace dfdyn::tests
