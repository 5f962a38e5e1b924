// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/options.hpp"

#include "tools/base/system/atomic_file.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"

#include <iostream>

namespace dfdyn::tools {

void RecordingOptions::add_to(CLI::App& command) {
    command.add_option("--log", logs, "Recording(s), CSV, in order; the lag window restarts between them")
        ->required()
        ->delimiter(',')
        ->type_name("L.csv[,L2.csv...]");
    command
        .add_option("--rows", rows,
                    "Only rows FIRST:LAST of each (from 0, LAST not included, either may be empty)")
        ->type_name("FIRST:LAST")
        ->capture_default_str();
    command.add_flag("--skip-bad-rows", skip_bad_rows,
                     "Leave bad rows out, as gaps, instead of refusing the file");
}

std::vector<Recording> RecordingOptions::read(std::size_t joint_count, OutputKind outputs) const {
    ReadOptions options;
    options.joint_count = joint_count;
    options.outputs = outputs;
    return read(options);
}

std::vector<Recording> RecordingOptions::read(ReadOptions options) const {
    options.rows = parse_row_range(rows);
    options.skip_bad_rows = skip_bad_rows;
    std::vector<Recording> recordings = read_recordings(logs, options);
    for (const Recording& recording : recordings) {
        if (&recording == &recordings.front() && !recording.ignored_columns.empty()) {
            std::cerr << recording.source << ": columns not used: " << listed(recording.ignored_columns)
                      << '\n';
        }
        if (recording.skipped.total() > 0) {
            std::cerr << recording.source << ": " << describe(recording.skipped) << '\n';
        }
    }
    return recordings;
}

void check_distinct(const std::vector<std::filesystem::path>& outputs,
                    std::vector<std::filesystem::path> inputs) {
    for (const std::filesystem::path& output : outputs) {
        if (output.empty()) {
            continue;
        }
        for (const std::filesystem::path& other : inputs) {
            if (std::filesystem::weakly_canonical(output) == std::filesystem::weakly_canonical(other)) {
                throw InputError(shown(output) +
                                 ": expected a file of its own, found one that another option names");
            }
        }
        inputs.push_back(output);
    }
}

void check_outputs(const std::vector<std::filesystem::path>& outputs,
                   std::vector<std::filesystem::path> inputs) {
    check_distinct(outputs, std::move(inputs));
    for (const std::filesystem::path& output : outputs) {
        if (!output.empty()) {
            check_writable(output);
        }
    }
}

OutputKind kind_of_outputs(const std::vector<std::string>& names, std::size_t joint_count) {
    for (const OutputKind kind : {OutputKind::joint_torque, OutputKind::motor_current, OutputKind::wrench}) {
        if (output_names(kind, joint_count) == names) {
            return kind;
        }
    }
    throw InputError(
        "outputs.names: expected the names of joint torques, motor currents or a wrench, found " +
        listed(names));
}

} // namespace dfdyn::tools
