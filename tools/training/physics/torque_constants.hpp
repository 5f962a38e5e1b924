// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"
#include "tools/training/data/training_data.hpp"

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
