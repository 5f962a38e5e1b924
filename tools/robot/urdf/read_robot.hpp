// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace dfdyn::tools {

struct ReadRobotOptions {
    std::string tip;  ///< link
    std::string base; ///< link; empty: the root
    /// m/s², in the frame of the URDF's root link. It is rotated into the base's frame with the joints
    /// between at zero.
    Eigen::Vector3d gravity{0, 0, -9.81};
    std::string ft_joint; ///< fixed joint of the F/T sensor; empty: determined automatically
    /// Direction of the measured wrench. Empty: the file's `measure_direction`, or child to parent without
    /// one.
    std::optional<bool> parent_to_child;
};

/// Reads the serial chain from base to tip of a URDF file. Revolute, continuous and prismatic joints of the
/// chain move. Links outside the chain, including those beyond the tip, are rigidly attached with their
/// joints at zero; their inertia is added to the link that carries them.
///
/// The F/T sensor, unless an option names its joint, is the one fixed joint of the chain with a `<sensor
/// type="force_torque">` in the file, under `<gazebo reference="JOINT">` or with `<parent joint="JOINT"/>`.
/// If the file has none for the chain, it is the one fixed joint of the chain with `force_torque`,
/// `ft_sensor` or the word `ft` in its name. For several candidates the robot has no sensor, and a note. The
/// sensor's frame is always the frame of the joint's child; a pose or frame in the file is ignored.
///
/// Throws InputError, one line with the file and the link or joint, for:
/// - a file that is not XML or no URDF (with urdfdom's message), or a missing link;
/// - a tip that is not below the base, no moving joint, or more than 64 of them;
/// - a zero axis, or a mimic, planar or floating joint within the chain;
/// - an `ft_joint` that is not fixed or not within the chain.
///
/// Adds notes for an impossible inertia, a moving link without mass, unusable limits, and a joint outside the
/// chain that mimics another.
Robot read_robot(const std::filesystem::path& path, const ReadRobotOptions& options);

} // namespace dfdyn::tools
