// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <filesystem>

namespace dfdyn::tools {

/// Reads a ROS 2 bag (see is_bag): positions, velocities and efforts (as torques or currents) of a topic of
/// sensor_msgs/msg/JointState, and for a wrench a topic of geometry_msgs/msg/WrenchStamped, interpolated at
/// the times of the joint states. Rows are in the order of the messages' stamps. Joints are in the order of
/// `options.joint_names`, otherwise of the first message; messages that lack one of them are not used.
///
/// Joint states between wrenches that are more than three usual steps of the slower topic apart are not used.
/// The usual step of the joint states is the median; that of the wrenches is the 98 % quantile, because some
/// sensors send in bursts. The next row then has `gap_before`, and a note counts them.
///
/// Throws InputError with the place for damaged content, topics or joints that are missing, and, unless
/// `skip_bad_rows`, rows with equal times or values that are not finite.
Recording read_bag_recording(const std::filesystem::path& path, const ReadOptions& options);

} // namespace dfdyn::tools
