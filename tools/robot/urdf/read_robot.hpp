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
    /// m/s², in the frame of the URDF's root link, turned into the base's with the joints between at zero.
    Eigen::Vector3d gravity{0, 0, -9.81};
    std::string ft_joint; ///< fixed joint of the F/T sensor; empty: found by itself
    /// Direction of the measured wrench. None: the file's own `measure_direction`, child to parent without.
    std::optional<bool> parent_to_child;
};

/// Reads the serial chain from base to tip of a URDF file. Revolute, continuous and prismatic joints of the
/// chain move. Every link beside the chain is rigidly attached, its joints held at zero, and counts into the
/// link it hangs on; so do those beyond the tip.
///
/// The F/T sensor, where no option names its joint: the one fixed joint of the chain for which the file has
/// a `<sensor type="force_torque">`, under `<gazebo reference="JOINT">` or with `<parent joint="JOINT"/>`;
/// where the file has none for the chain, the one fixed joint of the chain with `force_torque`, `ft_sensor`
/// or the word `ft` in its name. Several candidates: no sensor, and a note. The sensor's frame is always that
/// of the joint's child; a pose or frame that the file gives for it is not used.
///
/// Throws InputError, one line that names the file, and link or joint: not XML, no URDF (in urdfdom's words),
/// no such link, tip not below base, no moving joint, more than 64 of them, a zero axis, a mimic, planar or
/// floating joint within the chain, an `ft_joint` that is not fixed or not within the chain. Notes, not
/// errors: an inertia that no body can have, a moving link without mass, unusable limits, a joint beside the
/// chain that mimics another.
Robot read_robot(const std::filesystem::path& path, const ReadRobotOptions& options);

} // namespace dfdyn::tools
