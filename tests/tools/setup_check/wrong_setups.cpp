// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/setup_check/wrong_setups.hpp"

#include "tests/tools/setup_check/mistakes.hpp"
#include "tools/setup_check/checks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace dfdyn::tests {

using tools::Columns;
using tools::OutputKind;
using tools::Recording;
using tools::SetupFault;

namespace {

/// Every row nearest to a multiple of `step_s`; slower recordings keep all rows.
void thin(Recording& recording, double step_s) {
    Recording kept = cut(recording, 0, 0, 1);
    double next = recording.time_s.front();
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        if (recording.time_s[row] + 1e-9 >= next) {
            Recording one = cut(recording, row, row + 1, 1);
            kept.time_s.push_back(one.time_s.front());
            kept.time_ns.push_back(one.time_ns.front());
            kept.gap_before.push_back(kept.gap_before.empty() ? 1 : recording.gap_before[row]);
            std::ranges::copy(one.position.values, std::back_inserter(kept.position.values));
            std::ranges::copy(one.output.values, std::back_inserter(kept.output.values));
            next = std::max(next + step_s, recording.time_s[row] + step_s / 2);
        }
    }
    recording = std::move(kept);
}

/// Rounds the times to `step_s` and removes the rows of equal times, of a recording of 125 Hz.
void round_clock(Recording& recording, double step_s) {
    thin(recording, 0.008);
    Recording kept = cut(recording, 0, 0, 1);
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        const double time_s = step_s * std::round(recording.time_s[row] / step_s);
        if (!kept.time_s.empty() && time_s < kept.time_s.back() + step_s / 2) {
            continue;
        }
        const Recording one = cut(recording, row, row + 1, 1);
        kept.time_s.push_back(time_s);
        kept.time_ns.push_back(std::llround(1e9 * time_s));
        kept.gap_before.push_back(kept.gap_before.empty() ? 1 : recording.gap_before[row]);
        std::ranges::copy(one.position.values, std::back_inserter(kept.position.values));
        std::ranges::copy(one.output.values, std::back_inserter(kept.output.values));
    }
    recording = std::move(kept);
}

/// Limits an output to 70 % of its largest magnitude.
void saturate(Recording& recording, std::size_t output) {
    const double limit = 0.7 * tools::largest_magnitude(recording.output, output);
    change_outputs(recording, [&](double* y) { y[output] = std::clamp(y[output], -limit, limit); });
}

void wrap_all(Recording& recording) {
    const std::size_t joints = recording.joint_count();
    for (std::size_t joint = 0; joint < joints; ++joint) {
        double least = recording.position.values[joint];
        double largest = least;
        for (std::size_t i = joint; i < recording.position.values.size(); i += joints) {
            least = std::min(least, recording.position.values[i]);
            largest = std::max(largest, recording.position.values[i]);
        }
        const double middle = (least + largest) / 2; // the wrap, so that every moving joint has jumps
        change_positions(recording, [&](double* q) {
            q[joint] = std::remainder(q[joint] - middle + std::numbers::pi, 2 * std::numbers::pi);
        });
    }
}

void scale_masses(tools::Robot& robot, double factor) {
    for (tools::RobotJoint& joint : robot.joints) {
        joint.inertia *= factor;
    }
}

void hold_from_the_middle_on(Recording& recording, std::size_t output) {
    const std::size_t width = recording.output.names.size();
    const std::size_t middle = recording.row_count() / 2;
    for (std::size_t row = middle; row < recording.row_count(); ++row) {
        recording.output.values[row * width + output] = recording.output.values[middle * width + output];
    }
}

WrongSetup on_outputs(std::string name, SetupFault fault, std::function<void(double*)> change) {
    return {std::move(name), fault,
            [change = std::move(change)](Setup& setup) { change_outputs(setup.recording, change); }};
}

WrongSetup on_positions(std::string name, SetupFault fault, std::function<void(double*)> change) {
    return {std::move(name), fault,
            [change = std::move(change)](Setup& setup) { change_positions(setup.recording, change); }};
}

/// In place of q or tau 1 and 2, 2 and 3.
std::vector<WrongSetup> exchanges() {
    std::vector<WrongSetup> result;
    for (std::size_t first = 0; first < 2; ++first) {
        const std::string pair = std::to_string(first + 1) + " and " + std::to_string(first + 2);
        const auto swap = [first](double* x) { std::swap(x[first], x[first + 1]); };
        result.push_back(on_positions("positions " + pair + " exchanged", SetupFault::joint_order, swap));
        result.push_back(on_outputs("outputs " + pair + " exchanged", SetupFault::joint_order, swap));
    }
    return result;
}

} // namespace

std::vector<WrongSetup> wrong_setups(const tools::Robot& other, OutputKind outputs) {
    const std::string milli = outputs == OutputKind::motor_current ? "outputs in mA" : "outputs in mN·m";
    std::vector<WrongSetup> result{
        {"sign of all outputs", SetupFault::torque_sign, [](Setup& s) { scale(s.recording.output, -1); }},
        on_outputs("sign of output 1", SetupFault::torque_sign, [](double* y) { y[0] *= -1; }),
        on_outputs("sign of output 2", SetupFault::torque_sign, [](double* y) { y[1] *= -1; }),
        on_positions("sign of position 2", SetupFault::torque_sign, [](double* q) { q[1] *= -1; }),
        {"gravity upside down", SetupFault::gravity, [](Setup& s) { s.robot.gravity *= -1; }},
        {"another robot", SetupFault::wrong_robot, [other](Setup& s) { s.robot = other; }},
        {"masses in grams", SetupFault::wrong_robot, [](Setup& s) { scale_masses(s.robot, 1000); }},
        on_outputs("output 2 dead", SetupFault::dead_output, [](double* y) { y[1] = 0; }),
        on_outputs("output 1 dead", SetupFault::dead_output, [](double* y) { y[0] = 0.25; }),
        {"output 2 dead from the middle on", SetupFault::dead_output,
         [](Setup& s) { hold_from_the_middle_on(s.recording, 1); }},
        {"positions wrapped", SetupFault::wrapped_position, [](Setup& s) { wrap_all(s.recording); }},
        {"positions in degrees", SetupFault::position_unit,
         [](Setup& s) { scale(s.recording.position, 180 / std::numbers::pi); }},
        {"time in ms", SetupFault::time_unit, [](Setup& s) { scale_clock(s.recording, 1e3); }},
        {milli, SetupFault::output_unit, [](Setup& s) { scale(s.recording.output, 1e3); }},
        {"time rounded to 10 ms", SetupFault::clock, [](Setup& s) { round_clock(s.recording, 0.01); }},
        {"output 2 saturated", SetupFault::saturated_output, [](Setup& s) { saturate(s.recording, 1); }},
        on_positions("positions rounded to 0.01 rad", SetupFault::quantised_position,
                     [](double* q) {
                         for (int joint = 0; joint < 3; ++joint) {
                             q[joint] = 0.01 * std::round(100 * q[joint]);
                         }
                     }),
    };
    std::ranges::move(exchanges(), std::back_inserter(result));
    return result;
}

} // namespace dfdyn::tests
