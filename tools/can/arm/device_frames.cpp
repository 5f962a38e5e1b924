// SPDX-License-Identifier: Apache-2.0
#include "tools/can/arm/device_frames.hpp"

#include "tools/base/text/error.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

using hal::Frame;
using hal::icub::StrainBoard;

void append(const hal::FrameList& list, std::vector<Frame>& frames) {
    frames.insert(frames.end(), list.frame.begin(), list.frame.begin() + list.count);
}

void append(const DbcJoint& joint, const hal::JointValue& value, std::vector<DbcValue>& values) {
    values.push_back({&joint.config().position, value.position_rad});
    if (joint.config().effort) {
        values.push_back({&*joint.config().effort, value.effort});
    }
}

hal::Reason calibration_of(const AnySensor& sensor) {
    if (const auto* strain = std::get_if<StrainBoard>(&sensor.device())) {
        return strain->full_scale().reason();
    }
    const auto* ati = std::get_if<hal::AtiNetcan>(&sensor.device());
    return ati != nullptr ? ati->calibration() : hal::Reason::ok;
}

/// Null for another sensor, or none.
const StrainBoard* strain_board(const std::optional<AnySensor>& sensor) {
    return sensor ? std::get_if<StrainBoard>(&sensor->device()) : nullptr;
}

Frame full_scale_of(const StrainBoard& board, int channel) {
    return board.encode_full_scale(channel, board.full_scale()[static_cast<std::size_t>(channel)]);
}

bool same_message(const Frame& one, const Frame& other) {
    return one.id == other.id && !one.extended && one.length == other.length && one.data == other.data;
}

struct HeartbeatOf {
    std::optional<Frame> operator()(const hal::Cia402Drive& drive) const {
        return drive.encode_heartbeat(hal::Cia402Drive::State::operational);
    }
    std::optional<Frame> operator()(const hal::OdriveAxis& axis) const {
        return axis.encode_heartbeat(false);
    }
    template <class Device>
    std::optional<Frame> operator()(const Device& /*device*/) const {
        return std::nullopt;
    }
};

} // namespace

DeviceFrames::DeviceFrames(const BusDescription& description)
    : boards_(description.boards), sensor_(description.sensor), synchronous_(description.synchronous) {
    if (sensor_ && calibration_of(*sensor_) != hal::Reason::ok) {
        throw InputError(description.source + ": output.full_scale: expected the sensor's full scales, "
                                              "without which it sends nothing, found none");
    }
}

std::vector<Frame> DeviceFrames::joints(std::span<const double> position,
                                        std::span<const double> effort) const {
    std::vector<Frame> frames;
    std::vector<DbcValue> mapped; // joints of a DBC file may share frames
    for (const BusBoard& board : boards_) {
        std::array<hal::JointValue, 2> values{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (board.joint[i] != hal::unused_joint) {
                const auto joint = static_cast<std::size_t>(board.joint[i]);
                values[i].position_rad = position[joint];
                values[i].effort = effort.empty() ? 0 : effort[joint];
            }
        }
        if (const auto* joint = std::get_if<DbcJoint>(&board.board.device())) {
            append(*joint, values[0], mapped);
        } else {
            append(board.board.encode(values), frames);
        }
    }
    std::vector<Frame> shared(mapped.size());
    shared.resize(encode_fields(mapped, shared));
    frames.insert(frames.end(), shared.begin(), shared.end());
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
    return synchronous_ ? std::optional(hal::Cia402Drive::encode_sync()) : std::nullopt;
}

std::vector<Frame> DeviceFrames::heartbeats() const {
    std::vector<Frame> frames;
    for (const BusBoard& board : boards_) {
        if (const std::optional<Frame> frame = std::visit(HeartbeatOf{}, board.board.device())) {
            frames.push_back(*frame);
        }
    }
    return frames;
}

std::optional<Frame> DeviceFrames::answer(const Frame& request) const {
    const auto* strain = strain_board(sensor_);
    for (int channel = 0; strain != nullptr && channel < 6; ++channel) {
        if (same_message(request, strain->request_full_scale(channel))) {
            return full_scale_of(*strain, channel);
        }
    }
    return std::nullopt;
}

std::vector<Frame> DeviceFrames::full_scales() const {
    std::vector<Frame> frames;
    const auto* strain = strain_board(sensor_);
    for (int channel = 0; strain != nullptr && channel < 6; ++channel) {
        frames.push_back(full_scale_of(*strain, channel));
    }
    return frames;
}

} // namespace dfdyn::tools
