// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/setup_check/mistakes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace dfdyn::tests {

using tools::Columns;
using tools::OutputKind;
using tools::Recording;
using tools::SetupFault;

namespace {

constexpr double pi = std::numbers::pi;

/// Moves the wrap into the middle of each joint's range, so that every moving joint is wrapped.
void wrap(Recording& recording, std::size_t joint) {
    const std::size_t count = recording.joint_count();
    double least = recording.position.values[joint];
    double largest = least;
    for (std::size_t i = joint; i < recording.position.values.size(); i += count) {
        least = std::min(least, recording.position.values[i]);
        largest = std::max(largest, recording.position.values[i]);
    }
    const double middle = (least + largest) / 2;
    for (std::size_t i = joint; i < recording.position.values.size(); i += count) {
        double& angle = recording.position.values[i];
        angle = std::remainder(angle - middle + pi, 2 * pi);
    }
}

void add_output_mistakes(std::vector<Mistake>& mistakes, std::size_t joints, OutputKind outputs) {
    const std::size_t one = joints > 1 ? 1 : 0;
    const bool current = outputs == OutputKind::motor_current;
    mistakes.push_back({current ? "outputs in mA" : "outputs in mN·m", SetupFault::output_unit,
                        [](Recording& recording) { scale(recording.output, 1000); }});
    mistakes.push_back({"one output dead", SetupFault::dead_output, [one](Recording& recording) {
                            change_outputs(recording, [one](double* output) { output[one] = 0; });
                        }});
    mistakes.push_back({"sign of one output", SetupFault::torque_sign, [one](Recording& recording) {
                            change_outputs(recording, [one](double* output) { output[one] *= -1; });
                        }});
    mistakes.push_back({"sign of one position", SetupFault::torque_sign, [one](Recording& recording) {
                            change_positions(recording, [one](double* position) { position[one] *= -1; });
                        }});
    mistakes.push_back({"sign of all outputs", SetupFault::torque_sign,
                        [](Recording& recording) { scale(recording.output, -1); }});
    for (const auto& [first, second] : {std::pair<std::size_t, std::size_t>(1, 2), {1, 4}}) {
        if (second >= joints) {
            continue;
        }
        const std::string pair = std::to_string(first + 1) + " and " + std::to_string(second + 1);
        mistakes.push_back({"outputs " + pair + " exchanged", SetupFault::joint_order,
                            [a = first, b = second](Recording& recording) {
                                change_outputs(recording, [&](double* x) { std::swap(x[a], x[b]); });
                            }});
        mistakes.push_back({"positions " + pair + " exchanged", SetupFault::joint_order,
                            [a = first, b = second](Recording& recording) {
                                change_positions(recording, [&](double* x) { std::swap(x[a], x[b]); });
                            }});
    }
}

} // namespace

void scale(Columns& columns, double factor) {
    for (double& value : columns.values) {
        value *= factor;
    }
}

void change_positions(Recording& recording, const std::function<void(double*)>& change) {
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        change(recording.position.values.data() + row * recording.joint_count());
    }
}

void change_outputs(Recording& recording, const std::function<void(double*)>& change) {
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        change(recording.output.values.data() + row * recording.output.names.size());
    }
}

void scale_clock(Recording& recording, double factor) {
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        recording.time_s[row] *= factor;
        recording.time_ns[row] = std::llround(1e9 * recording.time_s[row]);
    }
}

std::vector<Mistake> classic_mistakes(std::size_t joints, OutputKind outputs) {
    std::vector<Mistake> mistakes{
        {"positions in degrees", SetupFault::position_unit,
         [](Recording& recording) { scale(recording.position, 180 / pi); }},
        {"time in ms", SetupFault::time_unit, [](Recording& recording) { scale_clock(recording, 1e3); }},
        {"time in µs", SetupFault::time_unit, [](Recording& recording) { scale_clock(recording, 1e6); }},
        {"time in ns", SetupFault::time_unit,
         [](Recording& recording) { // the longest time that a recording may have
             const double duration = recording.time_s.back() - recording.time_s.front();
             if (duration > 9) {
                 const auto rows = static_cast<double>(recording.row_count());
                 recording = cut(recording, 0, static_cast<std::size_t>(9 / duration * rows), 1);
             }
             for (std::size_t row = recording.row_count(); row-- > 0;) {
                 recording.time_s[row] -= recording.time_s.front();
             }
             scale_clock(recording, 1e9);
         }},
        {"one position wrapped", SetupFault::wrapped_position,
         [joints](Recording& recording) { wrap(recording, joints > 1 ? 1 : 0); }},
    };
    add_output_mistakes(mistakes, joints, outputs);
    return mistakes;
}

Recording cut(const Recording& recording, std::size_t first, std::size_t last, std::size_t stride) {
    Recording result;
    result.source = recording.source;
    result.position.names = recording.position.names;
    result.output.names = recording.output.names;
    const auto append = [](Columns& to, std::span<const double> row) {
        to.values.insert(to.values.end(), row.begin(), row.end());
    };
    for (std::size_t row = first; row < last; row += stride) {
        result.time_s.push_back(recording.time_s[row]);
        result.time_ns.push_back(recording.time_ns[row]);
        result.gap_before.push_back(row == first ? 1 : 0);
        append(result.position, recording.position.row(row));
        append(result.output, recording.output.row(row));
    }
    return result;
}

std::vector<Cut> cuts_of(const Recording& recording) {
    const std::size_t rows = recording.row_count();
    const double duration = recording.time_s.back() - recording.time_s.front();
    const double share = std::min(1.0, 20 / duration);
    const auto kept = static_cast<std::size_t>(share * static_cast<double>(rows));
    const std::size_t first = (rows - kept) / 2;
    return {{"whole", cut(recording, 0, rows, 1)},
            {"first half", cut(recording, 0, rows / 2, 1)},
            {"last half", cut(recording, rows / 2, rows, 1)},
            {"20 s", cut(recording, first, first + kept, 1)},
            {"every fifth", cut(recording, 0, rows, 5)}};
}

std::string mistakes_of(const tools::SetupFindings& findings) {
    std::string texts;
    for (const tools::SetupFinding& finding : findings) {
        texts += finding.severity == tools::Severity::mistake ? finding.text + "\n" : "";
    }
    return texts;
}

std::string mistakes_in(const Recording& recording, const tools::SetupQuestion& question) {
    return mistakes_of(check_setup(recording, question));
}

} // namespace dfdyn::tests
