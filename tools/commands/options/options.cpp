// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/options.hpp"

#include "tools/base/system/atomic_file.hpp"
#include "tools/base/system/file_place.hpp"
#include "tools/base/system/quiet.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <iostream>
#include <system_error>

namespace dfdyn::tools {

void RecordingOptions::add_to(CLI::App& command) {
    command
        .add_option("--log", logs,
                    "Recording(s), CSV (plain or .gz) or ROS 2 bag (MCAP or SQLite), in order; - is standard "
                    "input; the lag window restarts between "
                    "them")
        ->required()
        ->delimiter(',')
        ->transform([](const std::string& name) {
            std::error_code unknown;
            const bool exists = std::filesystem::exists(name, unknown);
            return exists ? name : std::string(trimmed(name)); // "a.csv, b.csv"
        })
        ->type_name("L.csv[,L2.csv...]");
    command
        .add_option(
            "--rows", rows,
            "Only rows FIRST:LAST of each (from 0, LAST not included, either may be empty); with STEP "
            "one row in STEP")
        ->type_name("FIRST:LAST[:STEP]")
        ->capture_default_str();
    command.add_flag("--skip-bad-rows", skip_bad_rows,
                     "Leave bad rows out, as gaps, instead of refusing the file");
    command
        .add_option(
            "--columns", columns,
            "Columns with other names than t, q1, qd1, tau1, i1, fx, ...: one pattern per quantity, with "
            "* for the joint's number or its name in the URDF, or the names separated by |")
        ->type_name("q=PATTERN,tau=PATTERN,...");
    command
        .add_option("--topic", topics,
                    "Topic of a ROS 2 bag with sensor_msgs/JointState, and for --outputs wrench one with "
                    "geometry_msgs/WrenchStamped; default: the only ones in the bag")
        ->delimiter(',')
        ->type_name("/T[,/W]");
    command
        .add_option(
            "--units", units,
            "Other units than s, rad, N m and A: of t (s, ms, us, ns), q and qd (rad, mrad, deg, turn, "
            "ticks:N per turn, m, mm), tau (Nm, mNm), i (A, mA), wrench (N, mN); one per quantity, or "
            "one per joint, separated by |")
        ->type_name("q=deg,t=ns,...");
}

std::vector<Recording> RecordingOptions::read_each_once(const ReadOptions& options) const {
    for (auto log = logs.begin(); log != logs.end(); ++log) {
        const auto same = [&](const std::filesystem::path& other) {
            return place_in_file_system(other) == place_in_file_system(*log);
        };
        if (std::any_of(logs.begin(), log, same)) {
            throw InputError("--log: expected each recording once, found " + shown(*log) + " twice");
        }
    }
    return read(options);
}

std::vector<Recording> RecordingOptions::read(ReadOptions options) const {
    options.rows = parse_row_range(rows);
    options.skip_bad_rows = skip_bad_rows;
    options.columns = parse_column_patterns(columns);
    options.units = parse_units(units);
    check_units(options.units, options.prismatic);
    options.topics = topics;
    std::vector<Recording> recordings = read_recordings(logs, options);
    for (const Recording& recording : recordings) {
        if (&recording == &recordings.front() && !recording.ignored_columns.empty()) {
            print_note(recording.source + ": columns not used: " + listed(recording.ignored_columns));
        }
        for (const std::string& note : recording.notes) {
            print_note(recording.source + ": " + note);
        }
        if (recording.skipped.total() > 0) {
            std::cerr << recording.source << ": " << describe(recording.skipped) << '\n';
        }
    }
    return recordings;
}

std::vector<std::filesystem::path>
RecordingOptions::with(const std::vector<std::filesystem::path>& others) const {
    std::vector<std::filesystem::path> files = logs;
    files.insert(files.end(), others.begin(), others.end());
    return files;
}

void refuse(bool wrong, const char* message) {
    if (wrong) {
        throw InputError(message);
    }
}

void check_distinct(const std::vector<std::filesystem::path>& outputs,
                    std::vector<std::filesystem::path> inputs) {
    for (const std::filesystem::path& output : outputs) {
        if (output.empty()) {
            continue;
        }
        for (const std::filesystem::path& other : inputs) {
            if (place_in_file_system(output) == place_in_file_system(other)) {
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
