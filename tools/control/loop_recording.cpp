// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop_recording.hpp"

#include "tools/recording/recording.hpp"

#include <algorithm>
#include <iterator>

namespace dfdyn::tools {

namespace {

std::vector<std::string> columns(std::size_t joints) {
    std::vector<std::string> names{"t"};
    for (const char* const prefix : {"q", "tau"}) {
        std::ranges::copy(joint_names(prefix, joints), std::back_inserter(names));
    }
    return names;
}

std::span<const double> values(const JointVector& vector) {
    return {vector.data(), static_cast<std::size_t>(vector.size())};
}

} // namespace

LoopRecording::LoopRecording(const std::filesystem::path& path, std::size_t joints, int every)
    : file_(path), csv_(file_.stream(), columns(joints)), every_(every) {}

void LoopRecording::add(const ClosedLoopInstant& instant) {
    if (tick_++ % every_ == 0 && instant.position.size() > 0 && instant.torque.size() > 0) {
        csv_.field(instant.time_s).fields(values(instant.position)).fields(values(instant.torque));
        csv_.end_row();
    }
}

} // namespace dfdyn::tools
