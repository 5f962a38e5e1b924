// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"
#include "tools/training/data/training_data.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// Motor current per torque of a joint.
struct TorqueGain {
    enum class Source {
        given,
        estimated,
        median, ///< median of the other joints
    };
    double gain = 1; ///< A/N·m, > 0
    Source source = Source::given;
};

/// Throws InputError unless `constants` (N·m/A) is empty or, for currents, has one positive number per joint.
void check_torque_constants(std::span<const double> constants, OutputKind outputs, std::size_t joints);

/// Estimates the gains of all joints, which are not part of the robot file: least squares of the measured
/// current with the nominal rigid body's torque, viscous friction, Coulomb friction and an offset, over all
/// rows. `data` must have velocities and accelerations. `sign_velocity`: of Coulomb friction (rad/s).
///
/// A joint whose nominal torque explains little of its current (a wrist) has no estimate of its own. If its
/// gain is below a third or above three times the median of the positive ones, it receives the median; 1 if
/// no joint has a positive gain.
std::vector<TorqueGain> estimate_torque_gains(const Robot& robot, const TrainingData& data,
                                              double sign_velocity);

} // namespace dfdyn::tools
