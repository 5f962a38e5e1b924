// SPDX-License-Identifier: Apache-2.0
#include "tools/can/arm/torque_frames.hpp"

#include "dfdyn/hal/bits.hpp"

#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr std::uint32_t first_id = 0x1DFD000;

float joint_torque(const hal::Frame& frame, std::size_t second) {
    return hal::load_little<float>(frame.data.data() + 4 * second);
}

} // namespace

TorqueFrames::TorqueFrames(const BusDescription& description)
    : joints_(static_cast<std::size_t>(description.joint_count)) {
    for (const BusBoard& board : description.boards) {
        for (int half = 0; half < static_cast<int>(board.joint.size()); ++half) {
            const int joint = board.joint[static_cast<std::size_t>(half)];
            if (joint != hal::unused_joint && board.board->torque_command(half, 0)) {
                drives_.push_back({board.board, half, static_cast<std::size_t>(joint)});
            }
        }
    }
    own_frames_ = drives_.size() < joints_;
}

std::span<const hal::Frame> TorqueFrames::encode(std::span<const double> torque) {
    frames_.clear();
    for (const Drive& drive : drives_) {
        frames_.push_back(*drive.board->torque_command(drive.half, torque[drive.joint]));
    }
    for (std::size_t joint = 0; own_frames_ && joint < joints_; joint += 2) {
        hal::Frame frame;
        frame.id = first_id + static_cast<std::uint32_t>(joint / 2);
        frame.extended = true;
        frame.length = 8;
        for (std::size_t second = 0; second < 2 && joint + second < joints_; ++second) {
            hal::store_little(frame.data.data() + 4 * second, static_cast<float>(torque[joint + second]));
        }
        frames_.push_back(frame);
    }
    return frames_;
}

bool TorqueFrames::take(const hal::Frame& frame, std::span<double> torque) const {
    for (const Drive& drive : drives_) {
        if (const std::optional<double> value = drive.board->commanded_torque(drive.half, frame)) {
            torque[drive.joint] = *value;
            return true;
        }
    }
    const bool own = own_frames_ && frame.extended && !frame.remote && !frame.error && !frame.fd &&
                     frame.length == 8 && frame.id >= first_id && frame.id < first_id + (joints_ + 1) / 2;
    if (!own || !std::isfinite(joint_torque(frame, 0)) || !std::isfinite(joint_torque(frame, 1))) {
        return false;
    }
    const std::size_t joint = 2 * (frame.id - first_id);
    for (std::size_t second = 0; second < 2 && joint + second < joints_; ++second) {
        torque[joint + second] = static_cast<double>(joint_torque(frame, second));
    }
    return true;
}

} // namespace dfdyn::tools
