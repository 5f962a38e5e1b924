// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/inertia.hpp"

#include <Eigen/Geometry>

#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A moving joint of a chain and its link, including everything fixed to that link. The link's frame is the
/// joint's.
struct RobotJoint {
    std::string name;
    std::string link;
    bool prismatic = false;
    Eigen::Isometry3d placement =
        Eigen::Isometry3d::Identity();                       ///< in the previous link's frame, at position 0
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();         ///< unit, in the link's frame
    InertialParameters inertia = InertialParameters::Zero(); ///< of the merged link, in its frame
    std::optional<double> lower, upper;     ///< rad, m; both or none: continuous joints have none
    std::optional<double> effort, velocity; ///< largest magnitudes, if the URDF has them
};

/// A force/torque sensor at a fixed joint within the chain.
struct ForceTorqueSensor {
    std::string joint;    ///< the fixed joint's name
    std::size_t link = 0; ///< link that carries it: 0 the base, i the link of joint i
    /// Pose of its frame (the frame of the fixed joint's child) in the frame of the carrying link.
    Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
    bool parent_to_child = false; ///< direction of the measured wrench
    InertialParameters inertia_beyond =
        InertialParameters::Zero(); ///< of the part of that link beyond it, in the link's frame
};

/// A serial chain from base to tip; fixed joints are merged.
struct Robot {
    std::string name, base, tip;
    std::vector<RobotJoint> joints; ///< from base to tip
    Eigen::Isometry3d tip_placement =
        Eigen::Isometry3d::Identity();    ///< of the tip's frame in the last link's
    Eigen::Vector3d gravity{0, 0, -9.81}; ///< m/s², in the base's frame
    /// rotation from the base's axes to the root's
    Eigen::Matrix3d base_in_root = Eigen::Matrix3d::Identity();
    std::optional<ForceTorqueSensor> sensor;
    std::vector<std::string> notes; ///< unusual but usable contents of the file; one line each
};

/// Returns the names of the joints, from base to tip.
std::vector<std::string> names_of_joints(const Robot& robot);

/// Returns, per joint, whether it is prismatic.
std::vector<bool> prismatic_joints(const Robot& robot);

} // namespace dfdyn::tools
