// SPDX-License-Identifier: Apache-2.0
// Mistakes in real recordings are found, and correct recordings are accepted.
#include "tools/setup_check/setup_check.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/setup_check/mistakes.hpp"
#include "tests/tools/setup_check/simulated_runs.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace setup_check_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;

const std::string data = DFDYN_TEST_DATA_DIR;

Recording currents(const std::string& file) {
    ReadOptions options;
    options.outputs = OutputKind::motor_current;
    return read_recording(data + "/" + file, options);
}

TEST_CASE("a correct recording is accepted however it is cut with and without a robot") {
    const Robot robot = ur5();
    const std::string file = GENERATE("ur5_kufieta/Movement_No5_Acc_slow_no_disturbance.csv",
                                      "ur5_kufieta/Movement_No7_Acc_slow_Verify_Model_short_with_"
                                      "disturbance.csv",
                                      "ur5_nist/halfspeed_payload_0p726kg.csv");
    CAPTURE(file);
    for (const Cut& one : cuts_of(currents(file))) {
        CAPTURE(one.name);
        CHECK(check_setup(one.recording, {OutputKind::motor_current}).empty());
        CHECK(check_setup(one.recording, {OutputKind::motor_current, &robot}).empty());
        CHECK(check_setup(one.recording, {OutputKind::motor_current, &robot, std::vector<double>(6, 10)})
                  .empty());
    }
}

TEST_CASE("no part of a short recording with uneven steps is taken for another robot's") {
    const Robot robot = ur5();
    for (const Cut& one : cuts_of(currents("ur5_kufieta/Movement_No3_Acc.csv"))) {
        CAPTURE(one.name);
        CHECK(mistakes_in(one.recording, {OutputKind::motor_current, &robot}) == "");
    }
}

/// Checks correct recordings of random arms, motions and loads: no mistake, and few warnings.
void check_right_runs(int count, std::mt19937_64& engine) {
    const std::vector<Robot> robots{ur5(), small_arm(), planar_arm(0), planar_arm(9.81), icub_right_arm(),
                                    tx40()};
    constexpr double most_warned = 0.3; // far above the usual 6 %
    int warned = 0;
    for (int run = 0; run < count; ++run) {
        const Robot& robot = robots[engine() % robots.size()];
        const OutputKind outputs = engine() % 3 == 0 && robot.sensor ? OutputKind::wrench
                                   : engine() % 2 == 0               ? OutputKind::joint_torque
                                                                     : OutputKind::motor_current;
        const RunKind kind = random_kind(robot, outputs, engine);
        const Recording recording = simulated_run(robot, kind, engine);
        CAPTURE(run, robot.name, kind.describe());
        for (const SetupQuestion& question : {SetupQuestion{outputs}, SetupQuestion{outputs, &robot}}) {
            const SetupFindings findings = check_setup(recording, question);
            CHECK(mistakes_of(findings) == "");
            warned += findings.empty() ? 0 : 1;
        }
    }
    CHECK(warned <= most_warned * 2 * count);
}

TEST_CASE("correct runs are accepted with slow motion or loads or resting joints or without gravity") {
    DFDYN_SEEDED_ENGINE(engine);
    check_right_runs(25, engine);
}

TEST_CASE("two thousand correct runs are accepted", "[.long]") {
    DFDYN_SEEDED_ENGINE(engine);
    check_right_runs(2000, engine);
}

struct Expected {
    const char* mistake;
    const char* words;
};

Recording with_mistake(Recording recording, const std::string& name) {
    for (const Mistake& mistake : classic_mistakes(recording.joint_count(), OutputKind::motor_current)) {
        if (mistake.name == name) {
            mistake.make(recording);
            return recording;
        }
    }
    FAIL("no mistake " << name);
    return recording;
}

TEST_CASE("a common mistake in a real recording is rejected with its remedy without a robot") {
    const Expected expected =
        GENERATE(Expected{"positions in degrees", "multiply by pi/180"},
                 Expected{"time in ms", "milliseconds; divide t by 1000"},
                 Expected{"time in µs", "microseconds; divide t by 1e6"},
                 Expected{"time in ns", "nanoseconds; divide t by 1e9"},
                 Expected{"one position wrapped", "column q2: expected a continuous"},
                 Expected{"outputs in mA", "looks like mA; divide by 1000"},
                 Expected{"one output dead", "column i2: expected values that vary"},
                 Expected{"sign of one output", "columns q2 and i2: expected an output"});
    CAPTURE(expected.mistake);
    const Recording right = currents("ur5_kufieta/Movement_No5_Acc_slow_no_disturbance.csv");
    CHECK_THAT(mistakes_in(with_mistake(right, expected.mistake), {OutputKind::motor_current}),
               ContainsSubstring(expected.words));
}

TEST_CASE("the six values of a wrench on an arm of six joints have no friction of joints") {
    const Recording reversed =
        with_mistake(currents("ur5_kufieta/Movement_No5_Acc_slow_no_disturbance.csv"), "sign of one output");
    REQUIRE_THAT(mistakes_in(reversed, {OutputKind::motor_current}), ContainsSubstring("columns q2 and i2"));
    CHECK(mistakes_in(reversed, {OutputKind::wrench}) == "");
}

TEST_CASE("with a robot wrong signs and exchanged columns of a real recording are rejected by name") {
    const Expected expected =
        GENERATE(Expected{"sign of one output", "i2: expected the sign of the robot's model"},
                 Expected{"sign of all outputs", "expected the sign of the robot's model"},
                 Expected{"outputs 2 and 3 exchanged", "outputs 2 and 3 look exchanged: columns i2 and i3"},
                 Expected{"positions 2 and 3 exchanged", " 2 and 3 look exchanged"});
    CAPTURE(expected.mistake);
    const Robot robot = ur5();
    const Recording right = currents("ur5_kufieta/Movement_No3_Acc.csv");
    CHECK_THAT(mistakes_in(with_mistake(right, expected.mistake), {OutputKind::motor_current, &robot}),
               ContainsSubstring(expected.words));
}

TEST_CASE("inverted gravity is reported as such and not as the sign of the outputs") {
    Robot robot = ur5();
    robot.gravity *= -1;
    const Recording right = currents("ur5_nist/halfspeed_payload_0p726kg.csv");
    const SetupFindings findings = check_setup(right, {OutputKind::motor_current, &robot});
    REQUIRE(findings.size() == 1);
    CHECK(findings.front().fault == SetupFault::gravity);
    CHECK_THAT(findings.front().text, ContainsSubstring("--gravity"));
}

TEST_CASE("torques in N·cm are reported as another unit with any payload") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = ur5();
    RunKind kind;
    kind.payload_kg = GENERATE(0.0, 5.0);
    kind.friction = 0.2;
    Recording recording = simulated_run(robot, kind, engine);
    CHECK(mistakes_in(recording, {kind.outputs, &robot}).empty());
    for (double& torque : recording.output.values) {
        torque *= 100;
    }
    CHECK_THAT(mistakes_in(recording, {kind.outputs, &robot}), ContainsSubstring("another unit"));
}

TEST_CASE("a wrench of the wrong sign is rejected with a reference to --wrench-direction") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = icub_right_arm();
    RunKind kind;
    kind.outputs = OutputKind::wrench;
    kind.noise = 0.05;
    Recording recording = simulated_run(robot, kind, engine);
    CHECK(check_setup(recording, {kind.outputs, &robot}).empty());
    for (double& value : recording.output.values) {
        value *= -1;
    }
    CHECK_THAT(mistakes_in(recording, {kind.outputs, &robot}), ContainsSubstring("--wrench-direction"));
}

TEST_CASE("an unsuitable robot or torque constants restrict the check to the recording alone") {
    const Robot small = small_arm();
    const Robot robot = ur5();
    const Recording right = currents("ur5_kufieta/Movement_No3_Acc.csv");
    CHECK(check_setup(right, {OutputKind::motor_current, &small}).empty());
    CHECK(check_setup(right, {OutputKind::motor_current, &robot, {5, -3}}).empty());
    CHECK(check_setup(right, {OutputKind::motor_current, &robot, {5, 5, 5, 5, 5, -3}}).empty());
}

TEST_CASE("recordings of a few rows are accepted") {
    const Recording right = currents("ur5_kufieta/Movement_No3_Acc.csv");
    const std::size_t rows = GENERATE(1U, 2U, 3U, 10U, 100U, 120U);
    const Robot robot = ur5();
    CHECK(mistakes_in(cut(right, 0, rows, 1), {OutputKind::motor_current, &robot}).empty());
}

} // namespace setup_check_test
