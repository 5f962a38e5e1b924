// SPDX-License-Identifier: Apache-2.0
#include "tools/control/report/loop_recording.hpp"

#include "tools/base/recording/csv_writer.hpp"
#include "tools/base/recording/recording.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

namespace dfdyn::tools {

namespace {

std::vector<std::string> columns(std::size_t joints) {
    std::vector<std::string> names{"t"};
    for (const char* const prefix : {"q", "tau"}) {
        std::ranges::copy(joint_names(prefix, joints), std::back_inserter(names));
    }
    return names;
}

} // namespace

LoopRecording::LoopRecording(int joints, int every, double period_s, double duration_s)
    : joints_(static_cast<std::size_t>(joints)), every_(every) {
    const auto rows = static_cast<std::size_t>(std::ceil(duration_s / (period_s * every))) + 1;
    time_ns_.reserve(rows);
    values_.reserve(rows * 2 * joints_);
}

void LoopRecording::add(const LoopInput& input) {
    const bool due = tick_++ % every_ == 0;
    const bool measured = input.position != nullptr && input.missing == nullptr && input.torque != nullptr;
    if (due && measured && time_ns_.size() < time_ns_.capacity()) {
        time_ns_.push_back(input.time_ns);
        std::ranges::copy(*input.position, std::back_inserter(values_));
        std::ranges::copy(*input.torque, std::back_inserter(values_));
    }
}

void LoopRecording::write(std::ostream& out) const {
    CsvWriter csv(out, columns(joints_));
    for (std::size_t row = 0; row < time_ns_.size(); ++row) {
        csv.field(1e-9 * static_cast<double>(time_ns_[row] - time_ns_.front()));
        csv.fields(std::span(values_).subspan(2 * joints_ * row, 2 * joints_));
        csv.end_row();
    }
}

} // namespace dfdyn::tools
