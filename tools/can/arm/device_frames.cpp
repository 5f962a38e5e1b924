// SPDX-License-Identifier: Apache-2.0
#include "tools/can/arm/device_frames.hpp"

#include "tools/base/text/error.hpp"
#include "tools/can/families/family.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

using hal::Frame;

void append(const hal::FrameList& list, std::vector<Frame>& frames) {
    frames.insert(frames.end(), list.frame.begin(), list.frame.begin() + list.count);
}

std::array<hal::JointValue, 2> values_of(const BusBoard& board, std::span<const double> position,
                                         std::span<const double> effort) {
    std::array<hal::JointValue, 2> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (board.joint[i] != hal::unused_joint) {
            const auto joint = static_cast<std::size_t>(board.joint[i]);
            values[i].position_rad = position[joint];
            values[i].effort = effort.empty() ? 0 : effort[joint];
        }
    }
    return values;
}

} // namespace

DeviceFrames::DeviceFrames(const BusDescription& description)
    : family_(description.joint_family), boards_(description.boards), sensor_(description.sensor),
      synchronous_(description.synchronous) {
    if (sensor_ && (*sensor_)->calibration() != hal::Reason::ok) {
        throw InputError(description.source + ": output.full_scale: expected the sensor's full scales, "
                                              "without which it sends nothing, found none");
    }
}

std::vector<Frame> DeviceFrames::joints(std::span<const double> position,
                                        std::span<const double> effort) const {
    std::vector<std::array<hal::JointValue, 2>> values;
    std::ranges::transform(boards_, std::back_inserter(values),
                           [&](const BusBoard& board) { return values_of(board, position, effort); });
    if (family_->encode_together != nullptr) {
        return family_->encode_together(boards_, values);
    }
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < boards_.size(); ++i) {
        append(boards_[i].board.encode(values[i]), frames);
    }
    return frames;
}

std::vector<Frame> DeviceFrames::wrench(std::span<const double> wrench) const {
    std::vector<Frame> frames;
    if (sensor_) {
        hal::Wrench values{};
        std::copy_n(wrench.begin(), values.size(), values.begin());
        append(sensor_->encode(values), frames);
    }
    return frames;
}

std::optional<Frame> DeviceFrames::sync() const {
    return synchronous_ ? std::optional(family_->sync()) : std::nullopt;
}

std::vector<Frame> DeviceFrames::heartbeats() const {
    std::vector<Frame> frames;
    for (const BusBoard& board : boards_) {
        if (const std::optional<Frame> frame = board.board->heartbeat()) {
            frames.push_back(*frame);
        }
    }
    return frames;
}

std::optional<Frame> DeviceFrames::answer(const Frame& request) const {
    return sensor_ ? (*sensor_)->answer(request) : std::nullopt;
}

std::vector<Frame> DeviceFrames::full_scales() const {
    return sensor_ ? (*sensor_)->answers() : std::vector<Frame>();
}

} // namespace dfdyn::tools
