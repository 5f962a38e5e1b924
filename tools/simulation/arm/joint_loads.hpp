// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Springs between links: each pulls its joint towards its rest position.
struct JointSprings {
    JointVector stiffness; ///< N·m/rad
    JointVector rest;      ///< rad
};

/// Torque ripple of drive and gear, added to the joint's torque: amplitude · sin(cycles · q + phase).
struct TorqueRipple {
    JointVector amplitude; ///< N·m
    JointVector cycles;    ///< per turn of the joint
    JointVector phase;     ///< rad
};

/// An external contact: a smooth pulse peak · sin²(π (t - start) / (end - start)).
struct Contact {
    double start_s = 0, end_s = 1;
    std::optional<Eigen::Index> joint;               ///< empty: at the tip
    double peak = 0;                                 ///< N·m on that joint
    Eigen::Vector3d force = Eigen::Vector3d::Zero(); ///< N at the tip, in the base's frame, at the peak

    /// Returns the pulse at `time_s`, relative to its peak (0 to 1).
    double pulse(double time_s) const;
};

/// Torques on the joints that no controller models, in addition to friction.
struct JointLoads {
    std::optional<JointSprings> springs;
    std::optional<TorqueRipple> ripple;
    std::vector<Contact> contacts;
    /// Additional torques (N·m) as a function of positions and velocities; not part of a scenario's file.
    std::function<JointVector(const JointVector& position, const JointVector& velocity)> further;

    bool none() const noexcept { return !springs && !ripple && contacts.empty() && !further; }

    /// Returns the torque on the joints (N·m), without contacts at the tip.
    JointVector torque(const JointVector& position, const JointVector& velocity, double time_s) const;

    /// Returns the force at the tip, N in the base's frame.
    Eigen::Vector3d tip_force(double time_s) const;
};

} // namespace dfdyn::tools
