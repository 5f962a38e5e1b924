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
        const SetupFindings findings = check_wrapping(wrapped, nullptr);
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
    CHECK(check_wrapping(turning, nullptr).empty());
    Recording gap = swinging();
    for (std::size_t i = 2 * std::size_t{1000}; i < gap.position.values.size(); ++i) {
        gap.position.values[i] += 2 * pi;
    }
    CHECK(check_wrapping(gap, nullptr).size() == 2);
    Recording marked = gap;
    marked.gap_before[1000] = 1;
    CHECK(check_wrapping(marked, nullptr).empty());
    for (std::size_t row = 1000; row < gap.row_count(); ++row) { // a gap of ten seconds
        gap.time_ns[row] += 10'000'000'000;
    }
    CHECK(check_wrapping(gap, nullptr).empty());
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
    Recording stuck = rounded;
    for (std::size_t row = 471; row < 1885; ++row) { // from peak to peak, 14 s
        stuck.output.values[2 * row] = 7.5;
    }
    check_single(check_dead_outputs(stuck, OutputKind::motor_current, nullptr), Severity::mistake,
                 "column tau1: expected values that vary, found 7.5 in every row from t");
    for (std::size_t row = 500; row < 800; ++row) { // 3 s
        rounded.output.values[2 * row] = 2.5;
    }
    CHECK(check_dead_outputs(rounded, OutputKind::motor_current, nullptr).empty());
}

TEST_CASE("an output that is clipped at a limit is saturated but not one that varies by rounding errors") {
    Recording clipped = swinging();
    change_outputs(clipped, [](double* tau) { tau[1] = std::min(tau[1], 5.0); });
    check_single(check_saturated_outputs(clipped, OutputKind::joint_torque), Severity::mistake,
                 "column tau2: expected values below the sensor's or the drive's limit, found 5");
    CHECK(check_saturated_outputs(swinging(), OutputKind::joint_torque).empty());
    Recording held = swinging();
    change_outputs(held, [](double* tau) { tau[1] = tau[0] > 0 ? 5 : 5 + 9e-16; });
    CHECK(check_saturated_outputs(held, OutputKind::joint_torque).empty());
    CHECK(check_dead_outputs(held, OutputKind::joint_torque, nullptr).empty());
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
    robot.joints[1].inertia = body_parameters(1, {0, 0, 0.1}, Eigen::Matrix3d::Zero());
    CHECK(check_dead_outputs(dead, OutputKind::joint_torque, &robot).empty());
}

TEST_CASE("impossibly large outputs are mA or mN·m and whole numbers above 200 are a warning") {
    Recording current = swinging(100, 1.2, "i");
    CHECK(check_output_unit(current, OutputKind::motor_current, nullptr).empty());
    for (double& value : current.output.values) {
        value *= 1000;
    }
    check_single(check_output_unit(current, OutputKind::motor_current, nullptr), Severity::mistake,
                 "columns i1, i2: expected A, found up to 7.5e+03: looks like mA; divide by 1000");
    for (double& value : current.output.values) {
        value = std::round(0.04 * value);
    }
    check_single(check_output_unit(current, OutputKind::motor_current, nullptr), Severity::warning,
                 "looks like mA");
    current.output.values[0] += 0.5; // 300.5 A is possible for a press
    CHECK(check_output_unit(current, OutputKind::motor_current, nullptr).empty());
    Recording torque = swinging();
    for (double& value : torque.output.values) {
        value *= 10000;
    }
    check_single(check_output_unit(torque, OutputKind::joint_torque, nullptr), Severity::mistake,
                 "looks like mN·m");
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
    scale(degrees.position, 180 / pi);
    check_single(check_position_unit(degrees, &robot), Severity::mistake, "looks like degrees");
    scale(degrees.position, 1000 * pi / 180);
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

/// Two joints of which the second slides, with limits of 3 rad and 6 m.
Robot turning_and_sliding() {
    Robot robot = with_limits(-3, 3);
    robot.joints[1].prismatic = true;
    robot.joints[1].lower = -6;
    robot.joints[1].upper = 6;
    return robot;
}

TEST_CASE("slides in millimetres are named with one unit per joint and are never wrapped") {
    const Robot robot = turning_and_sliding();
    Recording millimetres = swinging();
    change_positions(millimetres, [](double* q) { q[1] = 360 + 370 * std::sin(20 * q[1]); });
    const SetupFindings sliding = check_position_unit(millimetres, &robot);
    check_single(sliding, Severity::mistake, "expected m, found what looks like thousandths (mm)");
    CHECK_THAT(sliding[0].text, ContainsSubstring("divide q2 by 1000, or --units 'q=rad|mm'"));
    change_positions(millimetres, [](double* q) { q[0] *= 180 / pi; });
    check_single(check_position_unit(millimetres, &robot), Severity::mistake,
                 "multiply q1 by pi/180, divide q2 by 1000, or --units 'q=deg|mm'");
    Recording jumping = swinging();
    for (std::size_t row = 1000; row < jumping.row_count(); ++row) {
        jumping.position.values[2 * row + 1] += 360;
    }
    CHECK(check_wrapping(jumping, nullptr).size() == 1);
    CHECK(check_wrapping(jumping, &robot).empty());
}

TEST_CASE("continuous joints of a robot may turn several times") {
    Recording turning = swinging();
    turning.position.names = joint_names("q", 4); // as two rows of four joints
    turning.position.values.insert(turning.position.values.end(), turning.position.values.begin(),
                                   turning.position.values.end());
    change_positions(turning, [](double* q) { std::for_each_n(q, 4, [](double& one) { one *= 20; }); });
    check_single(check_position_unit(turning, nullptr), Severity::mistake, "looks like degrees");
    Robot robot;
    robot.joints.resize(4);
    check_single(check_position_unit(turning, &robot), Severity::warning, "unless the continuous joints");
    for (RobotJoint& joint : robot.joints) {
        joint.lower = joint.upper = 0.0; // placeholders
    }
    CHECK(any_mistake(check_position_unit(turning, &robot)));
    Robot wide = with_limits(-100, 100);
    wide.joints.resize(4, wide.joints.front());
    check_single(check_position_unit(turning, &wide), Severity::warning, "or those within their limits");
}

TEST_CASE("torques of a heavy arm are not taken for mN·m") {
    Recording heavy = swinging();
    scale(heavy.output, 5000);
    Robot robot = with_limits(-3, 3);
    check_single(check_output_unit(heavy, OutputKind::joint_torque, &robot), Severity::mistake, "mN·m");
    for (RobotJoint& joint : robot.joints) {
        joint.inertia = body_parameters(500, {1, 0, 0}, Eigen::Matrix3d::Identity());
        joint.placement.translation() = Eigen::Vector3d::UnitX();
    }
    CHECK(check_output_unit(heavy, OutputKind::joint_torque, &robot).empty());
    scale(heavy.output, 1000);
    check_single(check_output_unit(heavy, OutputKind::joint_torque, &robot), Severity::mistake, "mN·m");
}

/// Repeats a row in the rows from `first` to `last` (excluded), with all values times `factor`.
Recording with_filler(Recording recording, std::size_t first, std::size_t last, double factor = 1) {
    for (Columns* const columns : {&recording.position, &recording.output}) {
        for (std::size_t row = first; row < last; ++row) {
            for (std::size_t k = 0; k < 2; ++k) {
                columns->values[2 * row + k] = factor * columns->values[2 * first + k];
            }
        }
    }
    return recording;
}

TEST_CASE("equal rows before or after a jump are the filler of a stopped recorder") {
    CHECK(check_filler_rows(swinging()).empty());
    const Recording frozen = with_filler(with_filler(swinging(), 700, 1000), 1300, 1400);
    check_single(check_filler_rows(frozen), Severity::mistake, "found equal rows from t = 7");
    check_single(check_filler_rows(with_filler(swinging(), 0, 200, 0)), Severity::mistake,
                 "found equal rows from t = 0");
    check_single(check_filler_rows(with_filler(swinging(), 1900, 2000, 0)), Severity::mistake,
                 "the recorder stopped");
    Recording gap = with_filler(swinging(), 700, 1000);
    gap.gap_before[1000] = 1;
    CHECK(check_filler_rows(gap).empty());
}

TEST_CASE("an arm that rests between slow coarse steps is no filler") {
    Recording stepping = swinging(100, 0.02);
    const auto round = [](double step) {
        return [step](double* x) {
            std::for_each_n(x, 2, [&](double& one) { one = step * std::round(one / step); });
        };
    };
    change_positions(stepping, round(0.05)); // each value for more than a second
    change_outputs(stepping, round(5));
    CHECK(check_filler_rows(stepping).empty());
    Recording resting = swinging(); // 2 s of rest in each turn
    change_positions(resting, [](double* q) {
        std::for_each_n(q, 2, [](double& one) { one = std::clamp(one, -0.2, 0.3); });
    });
    change_outputs(resting, [](double* tau) { tau[0] = tau[1] = 1; });
    CHECK(check_filler_rows(resting).empty());
}

TEST_CASE("an output at its limit for seconds is saturated and not dead") {
    Recording clipped = swinging(100, 0.3); // turns take 19 s
    change_outputs(clipped, [](double* tau) { tau[1] = std::min(tau[1], 3.0); });
    CHECK(check_dead_outputs(clipped, OutputKind::joint_torque, nullptr).empty());
    CHECK(any_mistake(check_saturated_outputs(clipped, OutputKind::joint_torque)));
    for (std::size_t row = 0; row < 400; ++row) { // dead at an extreme value
        clipped.output.values[2 * row] = 30;
    }
    check_single(check_dead_outputs(clipped, OutputKind::joint_torque, nullptr), Severity::mistake,
                 "column tau1: expected values that vary, found 30 in every row from t");
}

} // namespace recording_checks_test
