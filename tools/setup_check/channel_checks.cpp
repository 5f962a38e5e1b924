// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/base/numerics/quantum.hpp"
#include "tools/base/recording/columns_matrix.hpp"
#include "tools/base/text/instant.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

constexpr std::size_t fewest_samples = 20;
constexpr double noticeable_travel = 0.1; ///< rad (m)

bool constant(const Columns& columns, std::size_t index) { return !(travel(columns, index) > 0); }

/// Returns whether a column varies by no more than rounding errors, as the torque that a simulation computes
/// for a stationary joint.
bool rounded(const Columns& columns, std::size_t index) {
    constexpr double rounding = 1e-12;
    return !(travel(columns, index) > rounding * largest_magnitude(columns, index));
}

/// Returns whether joint `joint` moves inertia by the robot's file; true without a robot. A thin last body
/// may have none about its own axis.
bool moves_mass(const Robot* robot, std::size_t joint) {
    if (robot == nullptr || joint >= robot->joints.size()) {
        return true;
    }
    const auto own = robot->joints.begin() + static_cast<std::ptrdiff_t>(joint);
    const InertialParameters& link = own->inertia; // mass, first moment, and xx xy xz yy yz zz
    const Eigen::Matrix3d about_origin{
        {link[4], link[5], link[6]}, {link[5], link[7], link[8]}, {link[6], link[8], link[9]}};
    const double moved = own->prismatic ? link[0] : own->axis.dot(about_origin * own->axis);
    return moved != 0 || std::any_of(own + 1, robot->joints.end(),
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
               recording.output.row(last)[output] == recording.output.row(row)[output]) {
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
    double least = recording.position.row(run.first)[joint];
    double largest = least;
    for (std::size_t row = run.first; row < run.first + run.count; ++row) {
        least = std::min(least, recording.position.row(row)[joint]);
        largest = std::max(largest, recording.position.row(row)[joint]);
    }
    return largest - least;
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
        if (recording.output.row(run.first)[output] != end) {
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
        const double distance = std::abs(recording.output.row(row)[output] - end);
        limit.near += distance > 0 && distance < 0.02 * range ? 1 : 0;
    }
    return limit;
}

struct Range {
    double low = 0, high = 0;
};

Range range_of(const Recording& recording, std::size_t output) {
    Range range{recording.output.row(0)[output], recording.output.row(0)[output]};
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        range.low = std::min(range.low, recording.output.row(row)[output]);
        range.high = std::max(range.high, recording.output.row(row)[output]);
    }
    return range;
}

bool saturated(const Limit& limit) {
    constexpr std::size_t fewest = 10;
    return limit.at >= fewest && limit.at > limit.near;
}

/// Returns whether a saturated output reaches the value of a run from nearby. The value of a dead channel can
/// also be the largest or smallest, but the output jumps to it.
bool clipped(const Recording& recording, std::size_t output, const Run& run) {
    constexpr double nearby = 0.1; // of the range
    const Range range = range_of(recording, output);
    const double value = recording.output.row(run.first)[output];
    if (value != range.low && value != range.high) {
        return false;
    }
    const std::size_t after = run.first + run.count;
    const double before_run = run.first > 0 ? recording.output.row(run.first - 1)[output] : value;
    const double after_run = after < recording.row_count() ? recording.output.row(after)[output] : value;
    const double step = std::max(std::abs(before_run - value), std::abs(after_run - value));
    return step < nearby * (range.high - range.low) &&
           saturated(limit_of(recording, output, value, range.high - range.low));
}

/// Detects outputs that are constant for 2 s while their joint moves, but vary elsewhere. In 10 s for outputs
/// of coarse steps, which friction at a steady speed may keep constant.
SetupFindings check_frozen_outputs(const Recording& recording, OutputKind outputs) {
    constexpr double longest_fine_s = 2, longest_coarse_s = 10;
    SetupFindings findings;
    const Columns& columns = recording.output;
    for (std::size_t output = 0; outputs != OutputKind::wrench && output < columns.names.size(); ++output) {
        if (rounded(columns, output)) {
            continue;
        }
        const bool steps = coarse(recording, output); // no saturation is recognised in these
        const double longest_s = steps ? longest_coarse_s : longest_fine_s;
        for (const Run& run : runs_of(recording, output, fewest_samples)) {
            const double from_s = recording.time_s[run.first];
            const double to_s = recording.time_s[run.first + run.count - 1];
            if (to_s - from_s > longest_s && travel_in(recording, run, output) > noticeable_travel &&
                (steps || !clipped(recording, output, run))) {
                findings.push_back(
                    {SetupFault::dead_output, Severity::mistake, columns.names[output],
                     "column " + columns.names[output] + ": expected values that vary, found " +
                         number_text(columns.row(run.first)[output]) +
                         " in every row from t = " + instant_text(from_s) + " to " + instant_text(to_s) +
                         ": a dead channel; check its sensor, or use --rows"});
                break;
            }
        }
    }
    return findings;
}

/// Rows `first` to `last` (excluded) that repeat all positions and outputs.
struct Filler {
    std::size_t first = 0, last = 0;
};

bool repeats(const Recording& recording, std::size_t row) {
    const auto same = [&](const Columns& columns) {
        return std::ranges::equal(columns.row(row), columns.row(row - 1));
    };
    return recording.gap_before[row] == 0 && same(recording.position) && same(recording.output);
}

std::vector<Filler> filler_of(const Recording& recording) {
    constexpr double shortest_s = 0.2;
    constexpr std::size_t fewest = 5;
    std::vector<Filler> result;
    for (std::size_t first = 0; first < recording.row_count();) {
        std::size_t last = first + 1;
        while (last < recording.row_count() && repeats(recording, last)) {
            ++last;
        }
        if (last - first >= fewest && recording.time_s[last - 1] - recording.time_s[first] >= shortest_s) {
            result.push_back({first, last});
        }
        first = last;
    }
    return result;
}

/// Returns the magnitudes of the steps to each row from the one before, without those across gaps (0).
std::vector<double> steps_of(const Recording& recording, std::size_t joint) {
    std::vector<double> steps(recording.row_count(), 0);
    for (std::size_t row = 1; row < recording.row_count(); ++row) {
        if (recording.gap_before[row] == 0) {
            steps[row] =
                std::abs(recording.position.row(row)[joint] - recording.position.row(row - 1)[joint]);
        }
    }
    return steps;
}

/// Returns the filler next to which the joint jumps, from the magnitudes of its steps.
std::optional<Filler> filler_with_jump(const std::vector<Filler>& fillers, std::vector<double> steps) {
    constexpr double of_largest = 3;
    constexpr double of_median = 10; // encoders of coarse steps may rest for long before each step
    constexpr double least = 0.02;   // rad (m)
    std::vector<double> moving;
    std::ranges::copy_if(steps, std::back_inserter(moving), [](double step) { return step > 0; });
    const double usual = moving.empty() ? 0 : of_median * median(std::move(moving));
    std::vector<double> sizes; // the larger one of each filler
    for (const Filler& filler : fillers) {
        sizes.push_back(std::max(steps[filler.first], steps[filler.last % steps.size()])); // none at row 0
    }
    for (const Filler& filler : fillers) {
        steps[filler.first] = steps[filler.last % steps.size()] = 0;
    }
    const double large = std::max({of_largest * std::ranges::max(steps), usual, least});
    const auto jump = std::ranges::find_if(sizes, [&](double one) { return one > large; });
    return jump == sizes.end() ? std::nullopt
                               : std::optional(fillers[static_cast<std::size_t>(jump - sizes.begin())]);
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
                                number_text(columns.row(0)[output]) +
                                " in every row: a dead channel; check its sensor and its name"});
    }
    return findings;
}

SetupFindings check_saturated_outputs(const Recording& recording, OutputKind outputs) {
    SetupFindings findings;
    const Columns& columns = recording.output;
    for (std::size_t output = 0; outputs != OutputKind::wrench && output < columns.names.size(); ++output) {
        if (rounded(columns, output) || coarse(recording, output)) {
            continue;
        }
        const Range range = range_of(recording, output);
        for (const double end : {range.low, range.high}) {
            const Limit limit = limit_of(recording, output, end, range.high - range.low);
            if (saturated(limit)) {
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

SetupFindings check_filler_rows(const Recording& recording) {
    if (recording.row_count() < fewest_samples || !recording.output.present()) {
        return {};
    }
    const std::vector<Filler> fillers = filler_of(recording);
    for (std::size_t joint = 0; joint < recording.joint_count() && !fillers.empty(); ++joint) {
        if (const auto filler = filler_with_jump(fillers, steps_of(recording, joint))) {
            return {{SetupFault::dead_output, Severity::mistake, listed(recording.output.names),
                     "columns " + listed(recording.position.names) + ", " + listed(recording.output.names) +
                         ": expected measurements, found equal rows from t = " +
                         instant_text(recording.time_s[filler->first]) + " to " +
                         instant_text(recording.time_s[filler->last - 1]) + " and a jump of " +
                         recording.position.names[joint] +
                         ": the recorder stopped; delete these rows, or use --rows"}};
        }
    }
    return {};
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

} // namespace dfdyn::tools
