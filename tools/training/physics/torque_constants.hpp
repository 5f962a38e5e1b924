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
        median, ///< of the other joints'
    };
    double gain = 1; ///< A/N·m, > 0
    Source source = Source::given;
};

/// The gains of all joints, for which the robot file has nothing: least squares of
/// the measured current on the nominal rigid body's torque, viscous friction, Coulomb friction and an offset,
/// over all rows. `data` has velocities and accelerations. `sign_velocity`: of Coulomb friction (rad/s).
///
/// A joint whose nominal torque hardly explains its current (a wrist) has no gain of its own: below a third
/// or above three times the median of the positive ones it gets the median; 1 where no joint has a positive
/// one.
std::vector<TorqueGain> estimate_torque_gains(const Robot& robot, const TrainingData& data,
                                              double sign_velocity);

} // namespace dfdyn::tools
