// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/bag/ros_message.hpp"
#include "tools/base/recording/recording.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A message with its time.
template <class Message>
struct Stamped {
    std::int64_t time_ns = 0;
    Message message;
};

/// Messages of a bag from which a recording is made, in the order of their times.
struct BagContent {
    std::vector<Stamped<JointStateMessage>> joints; ///< at least one
    std::vector<Stamped<WrenchMessage>> wrenches;   ///< at least one if they are the outputs
    std::optional<OutputKind> outputs;              ///< to read
};

/// Returns whether the message has all joints of `names`.
bool has_joints(const JointStateMessage& message, std::span<const std::string> names);

/// Reads the messages of the requested topics, or of the only topic of each type. Of `options.output_choices`
/// takes a wrench if the first message with all of `options.joint_names` has no efforts. Throws InputError
/// for damaged content, and for topics that are missing or ambiguous.
BagContent read_bag_content(const std::filesystem::path& path, const ReadOptions& options);

} // namespace dfdyn::tools
