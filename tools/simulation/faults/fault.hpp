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
    std::optional<Eigen::Index> link;                ///< the joint that moves it, from 0; none: the tip
    Eigen::Vector3d point = Eigen::Vector3d::Zero(); ///< m, in the link's frame; the tip has its own
    Eigen::Vector3d force = Eigen::Vector3d::Zero(); ///< N, in the base's frame
};

/// What is wrong with an arm and its actuators.
struct ArmFaults {
    explicit ArmFaults(Eigen::Index joints);

    JointVector friction_factor; ///< times the friction that the scenario describes
    JointVector actuator_gain;   ///< torque over command
    JointVector actuator_limit;  ///< N·m; of the torque, beside the actuators' own limit
    JointVector load;            ///< N·m, of the surroundings on the joints
    std::vector<Push> pushes;
};

/// What is wrong with the encoders.
struct EncoderFaults {
    explicit EncoderFaults(Eigen::Index joints);

    std::array<bool, largest_simulated_chain> frozen{}; ///< shows what it last showed
    JointVector jump;                                   ///< rad, added to the reading
};

/// What is wrong with the torque sensors: reading · factor + bias.
struct TorqueSensorFaults {
    explicit TorqueSensorFaults(Eigen::Index joints);

    JointVector factor;
    JointVector bias; ///< N·m
};

/// What is wrong between the devices and the loop, and with the loop's time.
struct LinkFaults {
    double share_lost = 0;        ///< of the frames, either way, each by itself
    bool devices_silent = false;  ///< no frame of theirs arrives
    std::int64_t late_ns = 0;     ///< from when the loop's tick is due until it begins
    std::int64_t wall_set_ns = 0; ///< by how much the wall clock has been set since the motion began
    std::int64_t bus_set_ns = 0;  ///< likewise the clock of the bus: frames' stamps and `now` alike
};

/// All that is wrong at one time.
struct Faults {
    explicit Faults(Eigen::Index joints) : arm(joints), encoders(joints), torque_sensor(joints) {}

    ArmFaults arm;
    EncoderFaults encoders;
    TorqueSensorFaults torque_sensor;
    LinkFaults link;
};

/// Something that goes wrong at a time of its own, which counts from where the motion begins.
struct Fault {
    std::int64_t from_ns = 0;
    std::int64_t until_ns = std::numeric_limits<std::int64_t>::max(); ///< the first time without it
    std::function<void(Faults& faults)> act;                          ///< adds this one to those there are
};

} // namespace dfdyn::tools
