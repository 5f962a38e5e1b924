// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/recording_checks.hpp"

#include "tools/common/number.hpp"
#include "tools/common/quantile.hpp"
#include "tools/common/text.hpp"
#include "tools/recording/stretches.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

constexpr double longest_step_s = 0.19;
constexpr double shortest_step_s = 2e-5;
constexpr double least_duration_s = 10;
constexpr double two_turns = 4 * std::numbers::pi;
constexpr double fastest_joint = 60; ///< rad/s
constexpr double most_ampere = 1000;
constexpr double most_whole_ampere = 200;
constexpr double most_torque = 2e4; ///< N·m

double value(const Columns& columns, std::size_t row, std::size_t index) {
    return columns.values[row * columns.names.size() + index];
}

void check_clock(const Recording& recording, SetupFindings& findings) {
    const double step = recording.row_count() < 2 ? 0 : median_step_s(recording);
    if (step >= longest_step_s) {
        const char* const unit = step < 60 ? "milliseconds" : step < 6e4 ? "microseconds" : "nanoseconds";
        const char* const factor = step < 60 ? "1000" : step < 6e4 ? "1e6" : "1e9";
        findings.push_back({SetupFault::time_unit, Severity::mistake,
                            "column t: expected seconds, found rows " + rounded_text(step) +
                                " s apart: looks like " + unit + "; divide t by " + factor});
    } else if (step > 0 && step < shortest_step_s) {
        findings.push_back({SetupFault::time_unit, Severity::mistake,
                            "column t: expected seconds, found rows " + rounded_text(1e6 * step) +
                                " µs apart: does not look like seconds; convert t to seconds"});
    }
}

/// How often neighbouring rows differ by `turn`, to 3 %, between rows that hardly differ.
std::size_t jumps(const Recording& recording, std::size_t joint, double turn, std::size_t& first_row) {
    std::size_t count = 0;
    const auto step = [&](std::size_t row) {
        return std::abs(value(recording.position, row, joint) - value(recording.position, row - 1, joint));
    };
    for (std::size_t row = 2; row + 1 < recording.row_count(); ++row) {
        const bool joined = recording.gap_before[row - 1] == 0 && recording.gap_before[row] == 0 &&
                            recording.gap_before[row + 1] == 0;
        if (joined && std::abs(step(row) - turn) < 0.03 * turn && step(row - 1) < 0.1 * turn &&
            step(row + 1) < 0.1 * turn) {
            first_row = count == 0 ? row : first_row;
            ++count;
        }
    }
    return count;
}

void check_wrapping(const Recording& recording, SetupFindings& findings) {
    for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
        for (const double turn : {2 * std::numbers::pi, 360.0}) {
            std::size_t row = 0;
            const std::size_t count = jumps(recording, joint, turn, row);
            if (count > 0) {
                findings.push_back(
                    {SetupFault::wrapped_position, Severity::mistake,
                     "column " + recording.position.names[joint] + ": expected a continuous angle, found " +
                         std::to_string(count) + (count == 1 ? " jump" : " jumps") + " of one turn (" +
                         (turn > 10 ? "360" : "2 pi") + "), the first at row " + std::to_string(row) +
                         ": wrapped; unwrap it (numpy.unwrap, MATLAB unwrap)"});
                break;
            }
        }
    }
}

void check_dead_outputs(const Recording& recording, SetupFindings& findings) {
    constexpr std::size_t fewest_rows = 20;
    for (std::size_t output = 0;
         recording.row_count() >= fewest_rows && output < recording.output.names.size(); ++output) {
        const double first = value(recording.output, 0, output);
        bool constant = true;
        for (std::size_t row = 1; constant && row < recording.row_count(); ++row) {
            constant = value(recording.output, row, output) == first;
        }
        if (constant) {
            findings.push_back({SetupFault::dead_output, Severity::mistake,
                                "column " + recording.output.names[output] +
                                    ": expected outputs that vary, found " + recording.output.names[output] +
                                    " constant at " + number_text(first) +
                                    " in every row: a dead channel; check its sensor and its name"});
        }
    }
}

/// The 99.9 % quantile of the magnitudes of all outputs.
double usual_largest(const Columns& columns) {
    std::vector<double> magnitudes(columns.values.size());
    std::ranges::transform(columns.values, magnitudes.begin(), [](double one) { return std::abs(one); });
    return magnitudes.empty() ? 0 : quantile(std::move(magnitudes), 0.999);
}

/// The 99 % quantile of the speed of a joint, per second; 0 for too few rows.
double usual_speed(const Recording& recording, std::size_t joint) {
    std::vector<double> speeds;
    for (std::size_t row = 1; row < recording.row_count(); ++row) {
        if (recording.gap_before[row] == 0) {
            speeds.push_back(
                std::abs(value(recording.position, row, joint) - value(recording.position, row - 1, joint)) /
                (recording.time_s[row] - recording.time_s[row - 1]));
        }
    }
    return speeds.empty() ? 0 : quantile(std::move(speeds), 0.99);
}

void check_degrees(const Recording& recording, SetupFindings& findings) {
    std::vector<double> reach;
    std::vector<std::string> beyond;
    double fastest = 0;
    for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
        reach.push_back(largest_magnitude(recording.position, joint));
        if (reach.back() > two_turns) {
            beyond.push_back(recording.position.names[joint]);
            fastest = std::max(fastest, usual_speed(recording, joint));
        }
    }
    if (!reach.empty() && median(reach) > two_turns && (beyond.size() > 1 || fastest > fastest_joint)) {
        findings.push_back({SetupFault::position_unit, Severity::mistake,
                            "columns " + listed(beyond) + ": expected radians, found up to " +
                                rounded_text(std::ranges::max(reach)) +
                                ": looks like degrees; multiply by pi/180"});
    }
}

} // namespace

double largest_magnitude(const Columns& columns, std::size_t index) {
    double result = 0;
    for (std::size_t i = index; i < columns.values.size(); i += columns.names.size()) {
        result = std::max(result, std::abs(columns.values[i]));
    }
    return result;
}

SetupFindings check_recording(const Recording& recording) {
    SetupFindings findings;
    check_clock(recording, findings);
    check_wrapping(recording, findings);
    check_dead_outputs(recording, findings);
    return findings;
}

SetupFindings check_units(const Recording& recording, OutputKind outputs) {
    SetupFindings findings;
    check_degrees(recording, findings);
    const double largest = usual_largest(recording.output);
    const bool whole =
        std::ranges::all_of(recording.output.values, [](double one) { return one == std::round(one); });
    const bool current = outputs == OutputKind::motor_current;
    if (current && (largest > most_ampere || (whole && largest > most_whole_ampere))) {
        findings.push_back({SetupFault::output_unit, Severity::mistake,
                            "columns " + listed(recording.output.names) + ": expected A, found up to " +
                                rounded_text(largest) + ": looks like mA; divide by 1000"});
    } else if (outputs == OutputKind::joint_torque && largest > most_torque) {
        findings.push_back({SetupFault::output_unit, Severity::mistake,
                            "columns " + listed(recording.output.names) + ": expected N·m, found up to " +
                                rounded_text(largest) + ": looks like mN·m; divide by 1000"});
    }
    return findings;
}

SetupFindings check_duration(const Recording& recording) {
    const double duration_s =
        recording.row_count() == 0 ? 0 : recording.time_s.back() - recording.time_s.front();
    if (duration_s >= least_duration_s) {
        return {};
    }
    return {{SetupFault::short_recording, Severity::unanswerable,
             "the recording is " + rounded_text(duration_s) + " s long: causes need " +
                 rounded_text(least_duration_s) + " s at least, better 60"}};
}

} // namespace dfdyn::tools
