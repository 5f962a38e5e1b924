// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A topic of a ROS 2 bag.
struct BagTopic {
    std::string name; ///< `/joint_states`
    std::string type; ///< `sensor_msgs/msg/JointState`
};

/// One message of a bag, valid during the call that receives it.
struct BagMessage {
    const BagTopic& topic;
    std::int64_t log_time_ns;         ///< when it was recorded
    std::span<const std::byte> bytes; ///< in CDR
};

/// Receives each message of a bag, in the order of the file.
using BagVisitor = std::function<void(const BagMessage&)>;

/// Returns whether `path` is a ROS 2 bag: a file that begins as MCAP or SQLite files do, or a folder with
/// such files. Pipes and standard input are not.
bool is_bag(const std::filesystem::path& path);

/// Returns the files of a bag that is a folder, in the order of their numbers; otherwise the bag itself.
std::vector<std::filesystem::path> bag_files(const std::filesystem::path& path);

/// Visits all messages of an MCAP file. Throws InputError with the place for damaged or incomplete content.
void visit_mcap(const std::filesystem::path& path, const BagVisitor& visit);

/// Visits all messages of a rosbag2 file of SQLite. Throws InputError if it is damaged or no rosbag2 file.
void visit_sqlite_bag(const std::filesystem::path& path, const BagVisitor& visit);

/// Visits all messages of a bag; of a folder, file by file in the order of their numbers.
void visit_bag(const std::filesystem::path& path, const BagVisitor& visit);

} // namespace dfdyn::tools
