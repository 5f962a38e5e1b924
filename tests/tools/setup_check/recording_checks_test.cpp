// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/recording_checks.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

namespace recording_checks_test {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
constexpr double pi = std::numbers::pi;

/// Two joints that swing, 20 s at 100 Hz, with torques or currents that follow them.
Recording swinging(const std::string& output = "tau") {
    Recording recording;
    recording.source = "run.csv";
    recording.position.names = joint_names("q", 2);
    recording.output.names = joint_names(output, 2);
    for (int row = 0; row < 2000; ++row) {
        const double t = 0.01 * row;
        recording.time_s.push_back(t);
        recording.time_ns.push_back(std::llround(1e9 * t));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        for (const double phase : {0.0, 1.0}) {
            recording.position.values.push_back(0.9 * std::sin(1.3 * t + phase) + phase);
            recording.output.values.push_back(7.5 * std::cos(1.3 * t + phase));
        }
    }
    return recording;
}

Recording scaled_clock(Recording recording, double factor) {
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        recording.time_s[row] *= factor;
        recording.time_ns[row] = std::llround(1e9 * recording.time_s[row]);
    }
    return recording;
}

Recording with_positions(Recording recording, const std::function<double(double)>& change) {
    for (double& position : recording.position.values) {
        position = change(position);
    }
    return recording;
}

void check_single(const SetupFindings& findings, SetupFault fault, const std::string& words) {
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].fault == fault);
    CHECK(findings[0].severity == Severity::mistake);
    CHECK_THAT(findings[0].text, ContainsSubstring(words));
}

TEST_CASE("a plain recording has no finding") {
    CHECK(check_recording(swinging()).empty());
    CHECK(check_units(swinging(), OutputKind::joint_torque).empty());
    CHECK(check_units(swinging("i"), OutputKind::motor_current).empty());
    CHECK(check_duration(swinging()).empty());
}

TEST_CASE("a clock in another unit is named, from 50 Hz to 5 kHz") {
    const double rate_hz = GENERATE(50.0, 100.0, 1000.0, 5000.0);
    CAPTURE(rate_hz);
    const Recording seconds = scaled_clock(swinging(), 100 / rate_hz);
    CHECK(check_recording(seconds).empty());
    check_single(check_recording(scaled_clock(seconds, 1e3)), SetupFault::time_unit,
                 "milliseconds; divide t by 1000");
    check_single(check_recording(scaled_clock(seconds, 1e6)), SetupFault::time_unit,
                 "microseconds; divide t by 1e6");
    check_single(check_recording(scaled_clock(seconds, 1e9 / 8)), SetupFault::time_unit,
                 "nanoseconds; divide t by 1e9");
    check_single(check_recording(scaled_clock(seconds, 1e-3)), SetupFault::time_unit,
                 "does not look like seconds");
}

TEST_CASE("angles wrapped at half a turn are named with column and row, in radians and in degrees") {
    const auto wrapped = [](double turn) {
        return [turn](double angle) { return std::remainder(angle * turn / (2 * pi) + 0.4 * turn, turn); };
    };
    for (const double turn : {2 * pi, 360.0}) {
        CAPTURE(turn);
        const SetupFindings findings = check_recording(with_positions(swinging(), wrapped(turn)));
        REQUIRE(findings.size() == 2);
        CHECK(findings[0].fault == SetupFault::wrapped_position);
        CHECK_THAT(findings[0].text,
                   ContainsSubstring("column q1: ") && ContainsSubstring("the first at row"));
    }
    // A joint may turn beyond half a turn, and a gap may hide a whole one.
    CHECK(check_recording(with_positions(swinging(), [](double angle) { return 5 * angle; })).empty());
    Recording gap = swinging();
    for (std::size_t i = 2 * 1000; i < gap.position.values.size(); ++i) {
        gap.position.values[i] += 2 * pi;
    }
    CHECK(check_recording(gap).size() == 2);
    gap.gap_before[1000] = 1;
    CHECK(check_recording(gap).empty());
}

TEST_CASE("an output with one value in every row is a dead channel") {
    Recording recording = swinging();
    for (std::size_t i = 1; i < recording.output.values.size(); i += 2) {
        recording.output.values[i] = 0.25;
    }
    check_single(check_recording(recording), SetupFault::dead_output, "column tau2: ");
    recording.output.values[1] = 0.26;
    CHECK(check_recording(recording).empty());
}

TEST_CASE("degrees are named without a robot") {
    const auto in_degrees = [](double angle) { return angle * 180 / pi; };
    check_single(check_units(with_positions(swinging(), in_degrees), OutputKind::joint_torque),
                 SetupFault::position_unit, "columns q1, q2: expected radians");
    // One continuous joint that turned many times, slowly, beside one that swings.
    Recording turning = swinging();
    for (std::size_t row = 0; row < turning.row_count(); ++row) {
        turning.position.values[2 * row] = 0.02 * static_cast<double>(row);
    }
    CHECK(check_units(turning, OutputKind::joint_torque).empty());
}

TEST_CASE("mA and mN·m are named without a robot where no arm has as many A or N·m") {
    Recording current = swinging("i");
    for (double& value : current.output.values) {
        value *= 1000;
    }
    check_single(check_units(current, OutputKind::motor_current), SetupFault::output_unit,
                 "columns i1, i2: expected A, found up to 7.5e+03: looks like mA; divide by 1000");
    Recording small = swinging("i"); // 300 mA at most, as an integer register
    for (double& value : small.output.values) {
        value = std::round(40 * value);
    }
    check_single(check_units(small, OutputKind::motor_current), SetupFault::output_unit, "looks like mA");
    small.output.values[0] += 0.5; // 300.5 A of a press are possible
    CHECK(check_units(small, OutputKind::motor_current).empty());
    Recording torque = swinging();
    for (double& value : torque.output.values) {
        value *= 10000;
    }
    check_single(check_units(torque, OutputKind::joint_torque), SetupFault::output_unit, "looks like mN·m");
}

TEST_CASE("a recording of less than ten seconds cannot answer what its causes are") {
    const SetupFindings findings = check_duration(scaled_clock(swinging(), 0.4));
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].fault == SetupFault::short_recording);
    CHECK(findings[0].severity == Severity::unanswerable);
}

} // namespace recording_checks_test
