// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"

#include <cstddef>
#include <functional>
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

/// Returns the gain of each joint for currents, and nothing for other outputs. With `constants` (N·m/A) these
/// are their inverses, otherwise those of `estimate`, which is called only then. Throws InputError as
/// check_torque_constants() does, for currents.
std::vector<TorqueGain> torque_gains(const Robot& robot, OutputKind outputs,
                                     std::span<const double> constants,
                                     const std::function<std::vector<TorqueGain>()>& estimate);

/// Estimates the gains of all joints, which are not part of the robot file: least squares of the measured
/// current with the nominal rigid body's torque, a rotor's inertia, viscous friction, Coulomb friction and an
/// offset, over the rows in which the joint moves faster than `sign_velocity` (of Coulomb friction, rad/s).
///
/// A joint has no estimate of its own if its nominal torque explains less than a fifth of its current's
/// spread (a wrist), if the estimate's standard deviation (jackknife over eighths of the rows) exceeds a
/// tenth of it, or if it is below a third or above three times the median of the others. It then receives
/// this median. If no joint has an estimate, returns rough_torque_gains().
std::vector<TorqueGain> estimate_torque_gains(const Robot& robot, const RecordedMotion& recorded,
                                              double sign_velocity);

/// Estimates the gains over all rows, without a rotor's inertia. A gain below a third or above three times
/// the median of the positive ones is replaced by it; 1 if no joint has a positive gain. A diagnosis starts
/// from these: it searches for rotors, and for friction at rest, itself.
std::vector<TorqueGain> rough_torque_gains(const Robot& robot, const RecordedMotion& recorded,
                                           double sign_velocity);

/// Throws InputError if a gain that was not given is no motor's: below 1e-4 or above 1e4 A/N·m. The currents
/// then do not fit the robot, or have another unit.
void check_estimated_gains(std::span<const TorqueGain> gains);

/// Returns the outputs per N·m (N), one per output: the gains, or 1 without gains.
std::vector<double> output_gains(std::span<const TorqueGain> gains, std::size_t outputs);

} // namespace dfdyn::tools
