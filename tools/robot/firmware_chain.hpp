// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/physics/chain.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"

#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace dfdyn::tools {

/// Returns the number of bodies whose inertial parameters influence the outputs. For a wrench: the links
/// beyond the sensor, the first of them without its part on the base's side. The part of the base that a
/// sensor on the base carries never moves and is not counted. Throws std::logic_error for a wrench if the
/// robot has no sensor.
int body_count(const Robot& robot, OutputKind outputs);

/// Returns the robot's own inertial parameters for the columns of the outputs' regressor, body by body: 10
/// body_count numbers.
Eigen::VectorXd nominal_parameters(const Robot& robot, OutputKind outputs);

/// Returns the names of these parameters: `link2 mcx`.
std::vector<std::string> parameter_names(const Robot& robot, OutputKind outputs);

/// Returns the units of these parameters.
std::vector<std::string> parameter_units(const Robot& robot, OutputKind outputs);

template <class Scalar>
Placement<Scalar> firmware_placement(const Eigen::Isometry3d& placement) {
    Placement<Scalar> result{};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            result.rotation[3 * row + column] = static_cast<Scalar>(placement.linear()(row, column));
        }
        result.translation[row] = static_cast<Scalar>(placement.translation()[row]);
    }
    return result;
}

template <class Scalar>
ChainJoint<Scalar> firmware_joint(const RobotJoint& joint) {
    ChainJoint<Scalar> result{firmware_placement<Scalar>(joint.placement), {}, joint.prismatic};
    for (int i = 0; i < 3; ++i) {
        result.axis[i] = static_cast<Scalar>(joint.axis[i]);
    }
    return result;
}

/// Returns the run-time sizes of a dynamic chain for the robot; empty for a fixed chain.
template <class ChainType>
typename ChainType::Sizes firmware_sizes(const Robot& robot) {
    constexpr bool torques = std::is_same_v<typename ChainType::Output, JointTorques>;
    const int joints = static_cast<int>(robot.joints.size());
    return {extent<ChainType::joints>(joints), extent<ChainType::outputs>(torques ? joints : 6),
            extent<ChainType::bodies>(
                body_count(robot, torques ? OutputKind::joint_torque : OutputKind::wrench))};
}

/// Returns the firmware's constants of the sensor.
template <class Output, class Scalar>
typename Output::template Constants<Scalar> firmware_sensor(const ForceTorqueSensor& sensor) {
    return {static_cast<std::int32_t>(sensor.link), firmware_placement<Scalar>(sensor.placement),
            static_cast<Scalar>(sensor.parent_to_child ? 1 : -1)};
}

/// Returns the robot as constants of `ChainType`, a dfdyn::Chain of fixed or dynamic sizes, for torque or
/// wrench outputs. Throws std::logic_error if the sizes differ from the robot's, or if it has no sensor for a
/// wrench.
template <class ChainType, class Scalar>
typename ChainType::template Constants<Scalar> firmware_chain(const Robot& robot) {
    constexpr bool torques = std::is_same_v<typename ChainType::Output, JointTorques>;
    const int joints = static_cast<int>(robot.joints.size());
    const int bodies = body_count(robot, torques ? OutputKind::joint_torque : OutputKind::wrench);
    if ((ChainType::joints != dynamic && ChainType::joints != joints) ||
        (ChainType::bodies != dynamic && ChainType::bodies != bodies)) {
        throw std::logic_error("firmware_chain: the robot has " + std::to_string(joints) + " joints and " +
                               std::to_string(bodies) + " bodies, the chain's type others");
    }
    typename ChainType::template Constants<Scalar> result{};
    result.joint = Storage<ChainJoint<Scalar>, ChainType::joints>::zeros(extent<ChainType::joints>(joints));
    for (int i = 0; i < joints; ++i) {
        result.joint[i] = firmware_joint<Scalar>(robot.joints[static_cast<std::size_t>(i)]);
    }
    for (int i = 0; i < 3; ++i) {
        result.gravity[i] = static_cast<Scalar>(robot.gravity[i]);
    }
    if constexpr (!torques) {
        result.output = firmware_sensor<typename ChainType::Output, Scalar>(*robot.sensor);
    }
    return result;
}

} // namespace dfdyn::tools
