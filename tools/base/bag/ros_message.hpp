// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

inline constexpr const char* joint_state_type = "sensor_msgs/msg/JointState";
inline constexpr const char* wrench_type = "geometry_msgs/msg/WrenchStamped";

/// sensor_msgs/msg/JointState.
struct JointStateMessage {
    std::int64_t stamp_ns = 0; ///< of the header; 0: not set
    std::vector<std::string> names;
    std::vector<double> position, velocity, effort; ///< one per name, or empty
};

/// geometry_msgs/msg/WrenchStamped.
struct WrenchMessage {
    std::int64_t stamp_ns = 0;
    std::array<double, 6> wrench{}; ///< force (N), torque (N·m)
};

/// Decode a message in CDR (plain, either byte order). Throw InputError, starting with `what`, if the bytes
/// end early, a count is impossible, or an array has neither no entry nor one per name.
JointStateMessage decode_joint_state(std::span<const std::byte> bytes, const std::string& what);
WrenchMessage decode_wrench(std::span<const std::byte> bytes, const std::string& what);

} // namespace dfdyn::tools
