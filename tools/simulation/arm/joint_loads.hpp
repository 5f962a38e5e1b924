// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Springs between links: each pulls its joint to its rest.
struct JointSprings {
    JointVector stiffness; ///< N·m/rad
    JointVector rest;      ///< rad
};

/// What drive and gear take on top, once or several times per turn: amplitude · sin(cycles · q + phase).
struct TorqueRipple {
    JointVector amplitude; ///< N·m
    JointVector cycles;    ///< per turn of the joint
    JointVector phase;     ///< rad
};

/// The surroundings push: a smooth pulse peak · sin²(π (t - start) / (end - start)).
struct Contact {
    double start_s = 0, end_s = 1;
    std::optional<Eigen::Index> joint;               ///< none: at the tip
    double peak = 0;                                 ///< N·m on that joint
    Eigen::Vector3d force = Eigen::Vector3d::Zero(); ///< N at the tip, in the base's frame, at the peak

    /// 0 … 1.
    double pulse(double time_s) const;
};

/// Torques on the joints that no controller knows of, beside friction.
struct JointLoads {
    std::optional<JointSprings> springs;
    std::optional<TorqueRipple> ripple;
    std::vector<Contact> contacts;
    /// Whatever else acts on the joints (N·m), from their positions and velocities; not in a scenario's file.
    std::function<JointVector(const JointVector& position, const JointVector& velocity)> further;

    bool none() const noexcept { return !springs && !ripple && contacts.empty() && !further; }

    /// What acts on the joints, without contacts at the tip. N·m.
    JointVector torque(const JointVector& position, const JointVector& velocity, double time_s) const;

    /// What acts at the tip, N in the base's frame.
    Eigen::Vector3d tip_force(double time_s) const;
};

} // namespace dfdyn::tools
