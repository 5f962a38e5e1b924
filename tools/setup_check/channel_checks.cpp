// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tools/base/numerics/quantum.hpp"
#include "tools/base/recording/columns_matrix.hpp"
#include "tools/base/recording/stretches.hpp"
#include "tools/base/text/instant.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

constexpr std::size_t fewest_samples = 20;
constexpr double noticeable_travel = 0.1; ///< rad (m)

double cell(const Columns& columns, std::size_t row, std::size_t index) {
    return columns.values[row * columns.names.size() + index];
}

bool constant(const Columns& columns, std::size_t index) { return !(travel(columns, index) > 0); }

/// Returns whether the links moved by joint `joint` have inertia in the robot's file; true without a robot.
bool moves_mass(const Robot* robot, std::size_t joint) {
    if (robot == nullptr || joint >= robot->joints.size()) {
        return true;
    }
    return std::any_of(robot->joints.begin() + static_cast<std::ptrdiff_t>(joint), robot->joints.end(),
                       [](const RobotJoint& one) { return !one.inertia.isZero(0); });
}

bool moves(const Recording& recording) {
    for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
        if (travel(recording.position, joint) > noticeable_travel) {
            return true;
        }
    }
    return false;
}

/// Returns whether an output has steps of more than 1 % of its range. Many equal values at the end of its
/// range, or in a row, are then no sign of a saturated or dead channel.
bool coarse(const Recording& recording, std::size_t output) {
    constexpr double coarsest = 0.01; // of the range
    const auto column = columns_matrix(recording.output).col(static_cast<Eigen::Index>(output));
    const std::optional<double> quantum = quantum_of({column.begin(), column.end()});
    return quantum && *quantum > coarsest * travel(recording.output, output);
}

/// Rows of equal values of one output, without a gap.
struct Run {
    std::size_t first = 0, count = 0;
};

std::vector<Run> runs_of(const Recording& recording, std::size_t output, std::size_t shortest) {
    std::vector<Run> runs;
    for (std::size_t row = 0; row < recording.row_count();) {
        std::size_t last = row + 1;
        while (last < recording.row_count() && recording.gap_before[last] == 0 &&
               cell(recording.output, last, output) == cell(recording.output, row, output)) {
            ++last;
        }
        if (last - row >= shortest) {
            runs.push_back({row, last - row});
        }
        row = last;
    }
    return runs;
}

double travel_in(const Recording& recording, const Run& run, std::size_t joint) {
    double least = cell(recording.position, run.first, joint);
    double largest = least;
    for (std::size_t row = run.first; row < run.first + run.count; ++row) {
        least = std::min(least, cell(recording.position, row, joint));
        largest = std::max(largest, cell(recording.position, row, joint));
    }
    return largest - least;
}

/// Detects outputs that are constant for 2 s while their joint moves, but vary elsewhere. In 10 s for outputs
/// of coarse steps, which friction at a steady speed may keep constant.
SetupFindings check_frozen_outputs(const Recording& recording, OutputKind outputs) {
    constexpr double longest_fine_s = 2, longest_coarse_s = 10;
    SetupFindings findings;
    const Columns& columns = recording.output;
    for (std::size_t output = 0; outputs != OutputKind::wrench && output < columns.names.size(); ++output) {
        if (constant(columns, output)) {
            continue;
        }
        const double longest_s = coarse(recording, output) ? longest_coarse_s : longest_fine_s;
        for (const Run& run : runs_of(recording, output, fewest_samples)) {
            const double from_s = recording.time_s[run.first];
            const double to_s = recording.time_s[run.first + run.count - 1];
            if (to_s - from_s > longest_s && travel_in(recording, run, output) > noticeable_travel) {
                findings.push_back(
                    {SetupFault::dead_output, Severity::mistake, columns.names[output],
                     "column " + columns.names[output] + ": expected values that vary, found " +
                         number_text(cell(columns, run.first, output)) +
                         " in every row from t = " + instant_text(from_s) + " to " + instant_text(to_s) +
                         ": a dead channel; check its sensor, or use --rows"});
                break;
            }
        }
    }
    return findings;
}

/// Number of rows in which an output is at an end of its range, and near it.
struct Limit {
    double value = 0;
    std::size_t at = 0, near = 0; ///< rows
};

Limit limit_of(const Recording& recording, std::size_t output, double end, double range) {
    constexpr std::size_t shortest = 3;
    constexpr double moving = 5e-3; // rad (m) within a run
    Limit limit{end, 0, 0};
    for (const Run& run : runs_of(recording, output, shortest)) {
        if (cell(recording.output, run.first, output) != end) {
            continue;
        }
        for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
            if (travel_in(recording, run, joint) > moving) {
                limit.at += run.count;
                break;
            }
        }
    }
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        const double distance = std::abs(cell(recording.output, row, output) - end);
        limit.near += distance > 0 && distance < 0.02 * range ? 1 : 0;
    }
    return limit;
}

} // namespace

SetupFindings check_dead_outputs(const Recording& recording, OutputKind outputs, const Robot* robot) {
    SetupFindings findings = check_frozen_outputs(recording, outputs);
    if (recording.row_count() < fewest_samples || !moves(recording)) {
        return findings;
    }
    const Columns& columns = recording.output;
    std::vector<std::size_t> dead;
    for (std::size_t output = 0; output < columns.names.size(); ++output) {
        if (constant(columns, output)) {
            dead.push_back(output);
        }
    }
    for (const std::size_t output : dead) {
        const bool wrench = outputs == OutputKind::wrench;
        if (!wrench && !moves_mass(robot, output)) {
            continue;
        }
        const bool certain = !wrench && dead.size() < columns.names.size() &&
                             travel(recording.position, output) > noticeable_travel;
        findings.push_back({SetupFault::dead_output, certain ? Severity::mistake : Severity::warning,
                            columns.names[output],
                            "column " + columns.names[output] + ": expected values that vary, found " +
                                number_text(cell(columns, 0, output)) +
                                " in every row: a dead channel; check its sensor and its name"});
    }
    return findings;
}

SetupFindings check_saturated_outputs(const Recording& recording, OutputKind outputs) {
    constexpr std::size_t fewest = 10;
    SetupFindings findings;
    const Columns& columns = recording.output;
    for (std::size_t output = 0; outputs != OutputKind::wrench && output < columns.names.size(); ++output) {
        if (constant(columns, output) || coarse(recording, output)) {
            continue;
        }
        double low = cell(columns, 0, output);
        double high = low;
        for (std::size_t row = 0; row < recording.row_count(); ++row) {
            low = std::min(low, cell(columns, row, output));
            high = std::max(high, cell(columns, row, output));
        }
        for (const double end : {low, high}) {
            const Limit limit = limit_of(recording, output, end, high - low);
            if (limit.at >= fewest && limit.at > limit.near) {
                findings.push_back(
                    {SetupFault::saturated_output, Severity::mistake, columns.names[output],
                     "column " + columns.names[output] +
                         ": expected values below the sensor's or the drive's limit, found " +
                         number_text(end) + " in " + std::to_string(limit.at) +
                         " rows of motion: saturated; move more slowly, or leave these rows out "
                         "(--rows)"});
                break;
            }
        }
    }
    return findings;
}

SetupFindings check_quantised_positions(const Recording& recording) {
    constexpr double coarsest = 6.5e-3; // rad (m): ten bits a turn are 6.1 mrad
    SetupFindings findings;
    for (std::size_t joint = 0; joint < recording.joint_count() && recording.row_count() >= fewest_samples;
         ++joint) {
        const auto column = columns_matrix(recording.position).col(static_cast<Eigen::Index>(joint));
        const std::optional<double> quantum = quantum_of({column.begin(), column.end()});
        if (quantum && *quantum > coarsest) {
            const std::string& name = recording.position.names[joint];
            findings.push_back({SetupFault::quantised_position, Severity::mistake, name,
                                "column " + name + ": expected positions finer than " +
                                    rounded_text(coarsest) + " rad, found multiples of " +
                                    rounded_text(*quantum) + ": record them with more digits"});
        }
    }
    return findings;
}

namespace {

/// Deviation of a row's positions from the cubic through its four neighbours, and its slope there.
struct Deviation {
    double of_position = 0, slope = 0;
};

Deviation deviation(const Recording& recording, std::size_t row, std::size_t joint) {
    double predicted = 0;
    double slope = 0;
    const double time_s = recording.time_s[row];
    for (std::size_t i : {row - 2, row - 1, row + 1, row + 2}) {
        double weight = 1;
        double derivative = 0; // of the logarithm of the weight
        for (std::size_t j : {row - 2, row - 1, row + 1, row + 2}) {
            if (i != j) {
                weight *= (time_s - recording.time_s[j]) / (recording.time_s[i] - recording.time_s[j]);
                derivative += 1 / (time_s - recording.time_s[j]);
            }
        }
        predicted += weight * cell(recording.position, i, joint);
        slope += weight * derivative * cell(recording.position, i, joint);
    }
    return {cell(recording.position, row, joint) - predicted, slope};
}

/// The common time error of the moving joints, over all rows.
struct StampError {
    double squares_s2 = 0, rows = 0;
    double total = 0,
           left = 0; ///< squared deviations of the positions, before and after a common time error

    void add(const std::vector<Deviation>& joints) {
        double product = 0;
        double square = 0;
        for (const Deviation& one : joints) {
            product += one.of_position * one.slope;
            square += one.slope * one.slope;
        }
        const double error_s = product / square;
        for (const Deviation& one : joints) {
            total += one.of_position * one.of_position;
            left += std::pow(one.of_position - error_s * one.slope, 2);
        }
        squares_s2 += error_s * error_s;
        rows += 1;
    }
    double rms_s() const {
        constexpr double of_neighbours =
            1.9; // variance of a deviation, relative to the variance of one row's error
        return std::sqrt(squares_s2 / rows / of_neighbours);
    }
};

StampError stamp_error(const Recording& recording) {
    constexpr double moving = 0.05; // rad/s (m/s)
    StampError error;
    for (std::size_t row = 2; row + 2 < recording.row_count(); ++row) {
        const auto at = recording.gap_before.begin() + static_cast<std::ptrdiff_t>(row);
        if (std::any_of(at - 1, at + 3, [](auto gap) { return gap != 0; })) {
            continue;
        }
        std::vector<Deviation> joints;
        for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
            if (const Deviation one = deviation(recording, row, joint); std::abs(one.slope) > moving) {
                joints.push_back(one);
            }
        }
        if (joints.size() > 1) {
            error.add(joints);
        }
    }
    return error;
}

} // namespace

SetupFindings check_stamps(const Recording& recording) {
    constexpr double most_of_step = 0.15;
    constexpr double least_explained = 0.95;
    constexpr double fewest = 100;
    constexpr double longest_step_s = 0.025; // longer steps do not determine the motion between the rows
    const double step_s = median_step_s(recording);
    if (!(step_s < longest_step_s)) {
        return {};
    }
    const StampError error = stamp_error(recording);
    if (error.rows < fewest || !(error.left < (1 - least_explained) * error.total) ||
        error.rms_s() < most_of_step * step_s) {
        return {};
    }
    return {{SetupFault::clock, Severity::mistake, "t",
             "column t: expected the instants at which the positions were measured, found positions of all "
             "joints that are early or late by " +
                 rounded_text(1e3 * error.rms_s()) + " ms (rms) with rows " + rounded_text(1e3 * step_s) +
                 " ms apart: rounded or late time stamps; record t with more digits, or number the rows and "
                 "multiply by the step"}};
}

} // namespace dfdyn::tools
