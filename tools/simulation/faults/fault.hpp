// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// A constant force on a point that moves with the arm.
struct Push {
    std::optional<Eigen::Index> link; ///< index of the joint that moves it, from 0; empty: the tip
    Eigen::Vector3d point = Eigen::Vector3d::Zero(); ///< m, in the link's frame; not used for the tip
    Eigen::Vector3d force = Eigen::Vector3d::Zero(); ///< N, in the base's frame
};

/// Faults of an arm and its actuators.
struct ArmFaults {
    explicit ArmFaults(Eigen::Index joints);

    JointVector friction_factor; ///< factor on the friction of the scenario
    JointVector actuator_gain;   ///< ratio of torque to command
    JointVector actuator_limit;  ///< N·m; limit of the torque in addition to the actuators' own one
    JointVector load;            ///< N·m, external torque on the joints
    std::vector<Push> pushes;
};

/// Faults of the encoders.
struct EncoderFaults {
    explicit EncoderFaults(Eigen::Index joints);

    std::array<bool, largest_simulated_chain> frozen{}; ///< repeats its last reading
    JointVector jump;                                   ///< rad, added to the reading
};

/// Faults of the torque sensors: reading · factor + bias.
struct TorqueSensorFaults {
    explicit TorqueSensorFaults(Eigen::Index joints);

    JointVector factor;
    JointVector bias; ///< N·m
};

/// Faults of the connection between devices and loop, and of the loop's timing.
struct LinkFaults {
    double share_lost = 0;        ///< share of frames lost, independently, in both directions
    bool devices_silent = false;  ///< no frame of the devices arrives
    std::int64_t late_ns = 0;     ///< delay from the due time of the loop's tick to its start
    std::int64_t wall_set_ns = 0; ///< sum of the wall clock's steps since the motion began
    std::int64_t bus_set_ns = 0;  ///< sum of the bus clock's steps: it affects frames' stamps and `now`
};

/// All faults that are active at one time.
struct Faults {
    explicit Faults(Eigen::Index joints) : arm(joints), encoders(joints), torque_sensor(joints) {}

    ArmFaults arm;
    EncoderFaults encoders;
    TorqueSensorFaults torque_sensor;
    LinkFaults link;
};

/// A fault with its period of activity, counted from the beginning of the motion.
struct Fault {
    std::int64_t from_ns = 0;
    std::int64_t until_ns = std::numeric_limits<std::int64_t>::max(); ///< first time after the fault
    std::function<void(Faults& faults)> act;                          ///< adds this fault to `faults`
};

} // namespace dfdyn::tools
