// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/simulation_csv.hpp"

#include "tools/base/recording/recording.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

constexpr const char* joint_columns[] = {"q", "qd", "qdd", "tau", "i"};

void append(std::vector<std::string>& names, const std::vector<std::string>& more) {
    names.insert(names.end(), more.begin(), more.end());
}

bool named(const RecordingModel& recording, const char* column) {
    return std::ranges::count(recording.columns, column) > 0;
}

std::vector<std::string> recorded_names(const RecordingModel& recording, std::size_t joint_count) {
    std::vector<std::string> names{"t"};
    for (const char* column : joint_columns) {
        if (named(recording, column)) {
            append(names, joint_names(column, joint_count));
        }
    }
    if (named(recording, "wrench")) {
        append(names, output_names(OutputKind::wrench, joint_count));
    }
    return names;
}

std::vector<std::string> true_names(bool with_wrench, std::size_t joint_count) {
    std::vector<std::string> names{"t"};
    for (const char* column : {"q", "qd", "qdd", "tau", "friction"}) {
        append(names, joint_names(column, joint_count));
    }
    if (with_wrench) {
        append(names, output_names(OutputKind::wrench, joint_count));
    }
    append(names, {"tip_x", "tip_y", "tip_z"});
    return names;
}

template <class Vector>
std::span<const double> span_of(const Vector& values) {
    return {values.data(), static_cast<std::size_t>(values.size())};
}

} // namespace

SimulatedRecordingCsv::SimulatedRecordingCsv(std::ostream& out, const Scenario& scenario,
                                             std::size_t joint_count)
    : scenario_(scenario), csv_(out, recorded_names(scenario.recording, joint_count)) {}

bool SimulatedRecordingCsv::has(const char* column) const { return named(scenario_.recording, column); }

void SimulatedRecordingCsv::write(const SimulatedSample& sample) {
    csv_.field(sample.time_s);
    const JointVector* const values[] = {&sample.position, &sample.velocity, &sample.acceleration,
                                         &sample.torque};
    for (std::size_t k = 0; k < std::size(values); ++k) {
        if (has(joint_columns[k])) {
            csv_.fields(span_of(*values[k]));
        }
    }
    if (has("i")) {
        const JointVector current = scenario_.torque_sensor.current(sample.torque);
        csv_.fields(span_of(current));
    }
    if (has("wrench")) {
        csv_.fields(span_of(sample.wrench));
    }
    csv_.end_row();
}

SimulatedTruthCsv::SimulatedTruthCsv(std::ostream& out, bool with_wrench, std::size_t joint_count)
    : with_wrench_(with_wrench), csv_(out, true_names(with_wrench, joint_count)) {}

void SimulatedTruthCsv::write(const SimulatedTruth& truth) {
    csv_.field(truth.time_s);
    for (const JointVector* values :
         {&truth.position, &truth.velocity, &truth.acceleration, &truth.torque, &truth.friction}) {
        csv_.fields(span_of(*values));
    }
    if (with_wrench_) {
        csv_.fields(span_of(truth.wrench));
    }
    csv_.fields(span_of(truth.tip));
    csv_.end_row();
}

} // namespace dfdyn::tools
