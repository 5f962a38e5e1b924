// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/base/recording/stretches.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/setup_check.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;
constexpr double two_turns = 4 * std::numbers::pi;

// Clock: recordings are expected to have 50 Hz to 5 kHz, with steps of 0.2 to 20 in milliseconds.
constexpr double suspicious_step_s = 0.19;
constexpr double certain_step_s = 2;
constexpr double slowest_joint = 0.03; ///< rad/s: 30 rad/s in milliseconds
constexpr double fastest_joint = 60;   ///< rad/s

constexpr double most_ampere = 1000;
constexpr double most_whole_ampere = 200;
constexpr double most_torque = 2e4; ///< N·m

/// Returns the 99 % quantile of a joint's speed, per second; 0 for too few rows.
double speed_quantile(const Recording& recording, std::size_t joint) {
    std::vector<double> speeds;
    for (std::size_t row = 1; row < recording.row_count(); ++row) {
        if (recording.gap_before[row] == 0) {
            const double step = recording.position.row(row)[joint] - recording.position.row(row - 1)[joint];
            speeds.push_back(std::abs(step) / time_step_s(recording, row));
        }
    }
    return speeds.empty() ? 0 : quantile(std::move(speeds), 0.99);
}

double speed_of_fastest(const Recording& recording) {
    double fastest = 0;
    for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
        fastest = std::max(fastest, speed_quantile(recording, joint));
    }
    return fastest;
}

double largest_travel(const Recording& recording) {
    double largest = 0;
    for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
        largest = std::max(largest, travel(recording.position, joint));
    }
    return largest;
}

/// Returns the unit in which steps of this length are at most 150 ms.
std::string clock_unit(double step) {
    return step < 150     ? "milliseconds; " + unit_remedy("t", "ms")
           : step < 1.5e5 ? "microseconds; " + unit_remedy("t", "us")
                          : "nanoseconds; " + unit_remedy("t", "ns");
}

/// Returns the rows at which a joint jumps by `turn`, within 3 %.
std::vector<std::size_t> jumps(const Recording& recording, std::size_t joint, double turn, double longest_s) {
    std::vector<std::size_t> rows;
    const auto step = [&](std::size_t row) {
        return std::abs(recording.position.row(row)[joint] - recording.position.row(row - 1)[joint]);
    };
    const auto joined = [&](std::size_t row) {
        return recording.gap_before[row] == 0 && time_step_s(recording, row) < longest_s;
    };
    const auto jump = [&](std::size_t row) { return std::abs(step(row) - turn) < 0.03 * turn; };
    const auto quiet = [&](std::size_t row) { return step(row) < 0.1 * turn || jump(row); };
    for (std::size_t row = 2; row + 1 < recording.row_count(); ++row) {
        if (jump(row) && joined(row - 1) && joined(row) && joined(row + 1) && quiet(row - 1) &&
            quiet(row + 1)) {
            rows.push_back(row);
        }
    }
    return rows;
}

std::string names_of(const Columns& columns, const std::vector<std::size_t>& indices) {
    std::vector<std::string> names;
    for (const std::size_t index : indices) {
        names.push_back(columns.names[index]);
    }
    return listed(names);
}

/// Returns the largest magnitude that a joint's limits allow; 0 for placeholders (0 to 0) and continuous
/// joints.
double largest_limit(const RobotJoint& joint) {
    return joint.lower ? std::max(std::abs(*joint.lower), std::abs(*joint.upper)) : 0;
}

/// Returns whether a joint can reach a position by its file: a continuous joint, or one within its limits.
bool reaches(const RobotJoint& joint, double magnitude) {
    return !joint.lower || magnitude <= largest_limit(joint);
}

struct BeyondLimits {
    std::vector<std::size_t> joints;
    double factor = 0;               ///< largest
    double turning = 0, sliding = 0; ///< largest, of joints that are certainly in another unit
    bool certain() const { return turning > 0 || sliding > 0; }
};

BeyondLimits beyond_limits(const Recording& recording, const Robot& robot) {
    constexpr double tolerance = 1.2;
    constexpr double another_unit = 5; // above any error of an encoder's zero
    BeyondLimits result;
    for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
        const RobotJoint& one = robot.joints[joint];
        const double limit = largest_limit(one);
        const double largest = largest_magnitude(recording.position, joint);
        const double ratio = limit > 0 ? largest / (tolerance * limit) : 0;
        if (ratio > 1) {
            result.joints.push_back(joint);
            result.factor = std::max(result.factor, ratio);
        }
        if (ratio > another_unit && largest > (one.prismatic ? 5 : two_turns)) {
            double& of_type = one.prismatic ? result.sliding : result.turning;
            of_type = std::max(of_type, ratio);
        }
    }
    return result;
}

/// Joints of one type have one unit.
std::string other_units(const Recording& recording, const Robot& robot, const BeyondLimits& beyond) {
    const bool degrees = beyond.turning < 2 * degrees_per_radian;
    std::vector<JointUnit> units;
    for (const RobotJoint& joint : robot.joints) {
        const bool other = (joint.prismatic ? beyond.sliding : beyond.turning) > 0;
        units.push_back(!other                        ? JointUnit::si
                        : degrees && !joint.prismatic ? JointUnit::degrees
                                                      : JointUnit::thousandths);
    }
    const std::string turning = degrees ? "degrees" : "thousandths (mrad)";
    const std::string sliding = "thousandths (mm)";
    return (beyond.sliding == 0 ? "expected rad, found what looks like " + turning
            : beyond.turning == 0
                ? "expected m, found what looks like " + sliding
                : "expected rad and m, found what looks like " + turning + " and " + sliding) +
           "; " + position_remedy(recording, robot, units);
}

SetupFindings check_limits(const Recording& recording, const Robot& robot) {
    const BeyondLimits beyond = beyond_limits(recording, robot);
    if (beyond.joints.empty()) {
        return {};
    }
    return {{SetupFault::position_unit, beyond.certain() ? Severity::mistake : Severity::warning,
             names_of(recording.position, beyond.joints),
             "positions of joint " + counted_from_one(beyond.joints) + " are up to " +
                 rounded_text(beyond.factor) + " times beyond the joints' limits: " +
                 (beyond.certain() ? other_units(recording, robot, beyond)
                                   : "another zero, other limits or another robot")}};
}

/// Upper bound of the magnitudes (N·m, N) that gravity causes in a robot's outputs.
double largest_weight(const Robot& robot) {
    constexpr double gravity = 9.81;
    double mass = 0;
    double reach = 1 + robot.tip_placement.translation().norm();
    for (const RobotJoint& joint : robot.joints) {
        mass += joint.inertia[0];
        reach += joint.placement.translation().norm() + (joint.prismatic ? largest_limit(joint) : 0);
    }
    return gravity * mass * reach;
}

} // namespace

std::string unit_remedy(const std::string& quantity, const std::string& unit) {
    const std::string option = ", or --units " + quantity + "=" + unit;
    if (unit == "deg") {
        return "multiply by pi/180" + option;
    }
    return "divide " + std::string(quantity == "t" ? "t " : "") + "by " +
           (unit == "us"   ? "1e6"
            : unit == "ns" ? "1e9"
                           : "1000") +
           option;
}

std::string position_remedy(const Recording& recording, const Robot& robot,
                            const std::vector<JointUnit>& units) {
    std::vector<std::string> degrees;
    std::vector<std::string> thousandths;
    std::vector<std::string> options;
    for (std::size_t joint = 0; joint < units.size(); ++joint) {
        const std::string& column = recording.position.names[joint];
        if (units[joint] == JointUnit::degrees) {
            degrees.push_back(column);
            options.emplace_back("deg");
        } else if (units[joint] == JointUnit::thousandths) {
            thousandths.push_back(column);
            options.emplace_back(robot.joints[joint].prismatic ? "mm" : "mrad");
        } else {
            options.emplace_back(robot.joints[joint].prismatic ? "m" : "rad");
        }
    }
    if (std::ranges::count(options, options.front()) == std::ssize(options)) {
        return unit_remedy("q", options.front());
    }
    std::string text = degrees.empty() ? "" : "multiply " + listed(degrees) + " by pi/180, ";
    text += thousandths.empty() ? "" : "divide " + listed(thousandths) + " by 1000, ";
    for (const std::string& option : options) {
        text += (&option == &options.front() ? "or --units 'q=" : "|") + option;
    }
    return text + "'";
}

double travel(const Columns& columns, std::size_t index) {
    double least = columns.values.empty() ? 0 : columns.values[index];
    double largest = least;
    for (std::size_t i = index; i < columns.values.size(); i += columns.names.size()) {
        least = std::min(least, columns.values[i]);
        largest = std::max(largest, columns.values[i]);
    }
    return largest - least;
}

double largest_magnitude(const Columns& columns, std::size_t index) {
    double result = 0;
    for (std::size_t i = index; i < columns.values.size(); i += columns.names.size()) {
        result = std::max(result, std::abs(columns.values[i]));
    }
    return result;
}

SetupFindings check_clock(const Recording& recording) {
    const double step = recording.row_count() < 2 ? 1e-3 : median_step_s(recording);
    const auto finding = [](bool mistake, std::string text) {
        return SetupFindings{
            {SetupFault::time_unit, mistake ? Severity::mistake : Severity::warning, "t", std::move(text)}};
    };
    if (step >= suspicious_step_s) {
        const bool creeping = largest_travel(recording) > 0 && speed_of_fastest(recording) < slowest_joint;
        return finding(step >= certain_step_s || creeping, "column t: expected seconds, found rows " +
                                                               rounded_text(step) + " s apart: looks like " +
                                                               clock_unit(step));
    }
    if (step < shortest_step_s) {
        return finding(speed_of_fastest(recording) > fastest_joint,
                       "column t: expected seconds, found rows " + rounded_text(1e6 * step) +
                           " µs apart: does not look like seconds; convert t to seconds");
    }
    return {};
}

SetupFindings check_wrapping(const Recording& recording, const Robot* robot) {
    SetupFindings findings;
    if (recording.row_count() < 4) {
        return findings;
    }
    const double longest_s = 3 * median_step_s(recording);
    for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
        if (robot != nullptr && robot->joints[joint].prismatic) {
            continue;
        }
        for (const double turn : {2 * std::numbers::pi, 360.0}) {
            const std::vector<std::size_t> rows = jumps(recording, joint, turn, longest_s);
            if (!rows.empty()) {
                findings.push_back(
                    {SetupFault::wrapped_position, Severity::mistake, recording.position.names[joint],
                     "column " + recording.position.names[joint] + ": expected a continuous angle, found " +
                         std::to_string(rows.size()) + (rows.size() == 1 ? " jump" : " jumps") +
                         " of one turn (" + (turn > two_turns ? "360" : "2 pi") +
                         "), the first at t = " + number_text(recording.time_s[rows.front()]) +
                         ": wrapped; unwrap it (numpy.unwrap, MATLAB unwrap)"});
                break;
            }
        }
    }
    return findings;
}

SetupFindings check_output_unit(const Recording& recording, OutputKind outputs, const Robot* robot) {
    constexpr double of_weight = 20; // milli-newton metres are 1000 times as large
    const std::vector<double>& values = recording.output.values;
    if (values.empty() || outputs == OutputKind::wrench) {
        return {};
    }
    std::vector<double> magnitudes;
    bool whole = true;
    for (const double one : values) {
        magnitudes.push_back(std::abs(one));
        whole = whole && one == std::round(one);
    }
    const double largest = quantile(std::move(magnitudes), 0.999);
    const bool current = outputs == OutputKind::motor_current;
    const double heavy = robot == nullptr ? 0 : of_weight * largest_weight(*robot);
    const bool certain = largest > (current ? most_ampere : std::max(most_torque, heavy));
    if (!certain && !(current && whole && largest > most_whole_ampere)) {
        return {};
    }
    return {{SetupFault::output_unit, certain ? Severity::mistake : Severity::warning,
             listed(recording.output.names),
             "columns " + listed(recording.output.names) + ": expected " + (current ? "A" : "N·m") +
                 ", found up to " + rounded_text(largest) + ": " +
                 (current ? "looks like mA; " + unit_remedy("i", "mA")
                          : "another unit, looks like mN·m; " + unit_remedy("tau", "mNm"))}};
}

SetupFindings check_position_unit(const Recording& recording, const Robot* robot) {
    SetupFindings findings = robot == nullptr ? SetupFindings{} : check_limits(recording, *robot);
    std::vector<std::string> beyond;
    std::size_t limited = 0; // joints that cannot turn so far
    double largest = 0;
    for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
        const double magnitude = largest_magnitude(recording.position, joint);
        const RobotJoint* const one = robot == nullptr ? nullptr : &robot->joints[joint];
        if (magnitude > two_turns && (one == nullptr || !one->prismatic)) {
            beyond.push_back(recording.position.names[joint]);
            limited += one == nullptr || !reaches(*one, magnitude) ? 1 : 0;
            largest = std::max(largest, magnitude);
        }
    }
    const auto enough = [&](std::size_t count) { return count >= 3 && 2 * count >= recording.joint_count(); };
    if (any_mistake(findings) || !enough(beyond.size())) {
        return findings;
    }
    return {{SetupFault::position_unit, enough(limited) ? Severity::mistake : Severity::warning,
             listed(beyond),
             "columns " + listed(beyond) + ": expected rad, found up to " + rounded_text(largest) +
                 ": looks like degrees" +
                 (enough(limited)
                      ? ""
                      : " unless the continuous joints, or those within their limits, turn several times") +
                 "; " + unit_remedy("q", "deg")}};
}

} // namespace dfdyn::tools
