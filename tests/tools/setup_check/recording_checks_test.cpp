// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/setup_check/mistakes.hpp"
#include "tools/robot/inertia.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace recording_checks_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;
constexpr double pi = std::numbers::pi;

/// 2,000 rows of two joints that swing at up to `speed` (rad/s), with torques or currents that follow them.
Recording swinging(double rate_hz = 100, double speed = 1.2, const std::string& output = "tau") {
    Recording recording;
    recording.source = "run.csv";
    recording.position.names = joint_names("q", 2);
    recording.output.names = joint_names(output, 2);
    for (int row = 0; row < 2000; ++row) {
        const double t = row / rate_hz;
        recording.time_s.push_back(t);
        recording.time_ns.push_back(std::llround(1e9 * t));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        for (const double phase : {0.0, 1.0}) {
            recording.position.values.push_back(0.9 * std::sin(speed / 0.9 * t + phase) + phase);
            recording.output.values.push_back(7.5 * std::cos(speed / 0.9 * t + phase));
        }
    }
    return recording;
}

void check_single(const SetupFindings& findings, Severity severity, const std::string& words) {
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].severity == severity);
    CHECK_THAT(findings[0].text, ContainsSubstring(words));
}

Recording with_clock(Recording recording, double factor) {
    scale_clock(recording, factor);
    return recording;
}

TEST_CASE("clocks in milliseconds and microseconds and nanoseconds are mistakes from 50 Hz to 5 kHz") {
    const double rate_hz = GENERATE(50.0, 100.0, 500.0, 1000.0, 5000.0);
    const double speed = GENERATE(0.2, 3.0);
    CAPTURE(rate_hz, speed);
    const Recording seconds = swinging(rate_hz, speed * std::max(1.0, rate_hz / 500));
    CHECK(check_clock(seconds).empty());
    check_single(check_clock(with_clock(seconds, 1e3)), Severity::mistake, "milliseconds; divide t by 1000");
    check_single(check_clock(with_clock(seconds, 1e6)), Severity::mistake, "microseconds; divide t by 1e6");
    if (seconds.time_s.back() < 9) {
        check_single(check_clock(with_clock(seconds, 1e9)), Severity::mistake,
                     "nanoseconds; divide t by 1e9");
    }
}

TEST_CASE("neither slow rows nor slow motions are mistakes of the clock") {
    CHECK(check_clock(swinging(20)).empty());
    CHECK(check_clock(swinging(100, 0.001)).empty()); // 1 mrad/s
    CHECK(check_clock(swinging(5, 0.1)).front().severity == Severity::warning);
    CHECK(check_clock(swinging(1, 0.1)).front().severity == Severity::warning);
}

TEST_CASE("a clock in units longer than seconds is a mistake") {
    check_single(check_clock(with_clock(swinging(1000), 1.0 / 3600)), Severity::mistake,
                 "does not look like seconds");
}

TEST_CASE("angles wrapped at half a turn are reported with column and time in radians and degrees") {
    for (const double turn : {2 * pi, 360.0}) {
        CAPTURE(turn);
        Recording wrapped = swinging();
        change_positions(wrapped, [turn](double* q) {
            for (int i = 0; i < 2; ++i) {
                q[i] = std::remainder(q[i] * turn / (2 * pi) + 0.4 * turn, turn);
            }
        });
        const SetupFindings findings = check_wrapping(wrapped);
        REQUIRE(findings.size() == 2);
        CHECK(findings[0].severity == Severity::mistake);
        CHECK_THAT(findings[0].text, ContainsSubstring("column q1: expected a continuous angle") &&
                                         ContainsSubstring("the first at t = ") &&
                                         ContainsSubstring("unwrap"));
    }
}

TEST_CASE("several turns or fast motion or a gap are not reported as wrapping") {
    Recording turning = swinging();
    change_positions(turning, [](double* q) { q[0] *= 20; });
    CHECK(check_wrapping(turning).empty());
    Recording gap = swinging();
    for (std::size_t i = 2 * std::size_t{1000}; i < gap.position.values.size(); ++i) {
        gap.position.values[i] += 2 * pi;
    }
    CHECK(check_wrapping(gap).size() == 2);
    Recording marked = gap;
    marked.gap_before[1000] = 1;
    CHECK(check_wrapping(marked).empty());
    for (std::size_t row = 1000; row < gap.row_count(); ++row) { // a gap of ten seconds
        gap.time_ns[row] += 10'000'000'000;
    }
    CHECK(check_wrapping(gap).empty());
}

TEST_CASE("a constant output is a dead channel if its joint moves and other outputs vary") {
    Recording dead = swinging();
    change_outputs(dead, [](double* tau) { tau[1] = 0.25; });
    check_single(check_dead_outputs(dead, OutputKind::joint_torque, nullptr), Severity::mistake,
                 "column tau2: expected values that vary, found 0.25 in every row");
    Recording standing = dead;
    change_positions(standing, [](double* q) { q[1] = 0.3; });
    check_single(check_dead_outputs(standing, OutputKind::joint_torque, nullptr), Severity::warning, "tau2");
    Recording off = dead;
    change_outputs(off, [](double* tau) { tau[0] = 0; });
    const SetupFindings all_off = check_dead_outputs(off, OutputKind::joint_torque, nullptr);
    REQUIRE(all_off.size() == 2); // the motors have no power
    CHECK_FALSE(any_mistake(all_off));
    dead.output.values[1] = 0.26;
    check_single(check_dead_outputs(dead, OutputKind::joint_torque, nullptr), Severity::mistake,
                 "column tau2: expected values that vary, found 0.25 in every row from t");
}

TEST_CASE("outputs in steps of more than 1 % of their range are neither saturated nor dead") {
    Recording rounded = swinging(); // 31 levels
    change_outputs(rounded, [](double* tau) {
        for (int i = 0; i < 2; ++i) {
            tau[i] = 0.5 * std::round(2 * tau[i]);
        }
    });
    CHECK(check_saturated_outputs(rounded, OutputKind::motor_current).empty());
    CHECK(check_dead_outputs(rounded, OutputKind::motor_current, nullptr).empty());
    for (std::size_t row = 500; row < 800; ++row) { // 3 s
        rounded.output.values[2 * row] = 2.5;
    }
    CHECK(check_dead_outputs(rounded, OutputKind::motor_current, nullptr).empty());
}

TEST_CASE("an output that is clipped at a limit is saturated") {
    Recording clipped = swinging();
    change_outputs(clipped, [](double* tau) { tau[1] = std::min(tau[1], 5.0); });
    check_single(check_saturated_outputs(clipped, OutputKind::joint_torque), Severity::mistake,
                 "column tau2: expected values below the sensor's or the drive's limit, found 5");
    CHECK(check_saturated_outputs(swinging(), OutputKind::joint_torque).empty());
}

TEST_CASE("a joint that moves no mass has no dead output") {
    Recording dead = swinging();
    change_outputs(dead, [](double* tau) { tau[1] = 0; });
    Robot robot;
    robot.joints.resize(2);
    robot.joints[0].inertia = body_parameters(1, {0.5, 0, 0}, Eigen::Matrix3d::Identity());
    CHECK(check_dead_outputs(dead, OutputKind::joint_torque, &robot).empty());
    robot.joints[1].inertia = robot.joints[0].inertia;
    CHECK(any_mistake(check_dead_outputs(dead, OutputKind::joint_torque, &robot)));
}

TEST_CASE("impossibly large outputs are mA or mN·m and whole numbers above 200 are a warning") {
    Recording current = swinging(100, 1.2, "i");
    CHECK(check_output_unit(current, OutputKind::motor_current).empty());
    for (double& value : current.output.values) {
        value *= 1000;
    }
    check_single(check_output_unit(current, OutputKind::motor_current), Severity::mistake,
                 "columns i1, i2: expected A, found up to 7.5e+03: looks like mA; divide by 1000");
    for (double& value : current.output.values) {
        value = std::round(0.04 * value);
    }
    check_single(check_output_unit(current, OutputKind::motor_current), Severity::warning, "looks like mA");
    current.output.values[0] += 0.5; // 300.5 A is possible for a press
    CHECK(check_output_unit(current, OutputKind::motor_current).empty());
    Recording torque = swinging();
    for (double& value : torque.output.values) {
        value *= 10000;
    }
    check_single(check_output_unit(torque, OutputKind::joint_torque), Severity::mistake, "looks like mN·m");
}

/// Two joints with limits, or continuous joints.
Robot with_limits(double lower, double upper) {
    Robot robot;
    robot.joints.resize(2);
    for (RobotJoint& joint : robot.joints) {
        joint.lower = lower;
        joint.upper = upper;
    }
    return robot;
}

TEST_CASE("positions far beyond the joint limits are degrees or thousandths") {
    const Robot robot = with_limits(-3, 3);
    CHECK(check_position_unit(swinging(), &robot).empty());
    Recording degrees = swinging();
    change_positions(degrees, [](double* q) {
        q[0] *= 180 / pi;
        q[1] *= 180 / pi;
    });
    check_single(check_position_unit(degrees, &robot), Severity::mistake, "looks like degrees");
    change_positions(degrees, [](double* q) {
        q[0] *= 1000 * pi / 180;
        q[1] *= 1000 * pi / 180;
    });
    check_single(check_position_unit(degrees, &robot), Severity::mistake, "looks like thousandths");
}

TEST_CASE("meaningless joint limits do not cause a rejection") {
    Recording turning = swinging(); // many turns of a continuous joint
    change_positions(turning, [](double* q) { q[0] *= 100; });
    const Robot continuous = [] {
        Robot robot;
        robot.joints.resize(2);
        return robot;
    }();
    CHECK(check_position_unit(turning, &continuous).empty());
    const Robot placeholder = with_limits(0, 0);
    CHECK(check_position_unit(swinging(), &placeholder).empty());
    const Robot narrow = with_limits(-0.1, 0.1);
    CHECK_FALSE(any_mistake(check_position_unit(swinging(), &narrow)));
}

} // namespace recording_checks_test
