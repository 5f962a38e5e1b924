// SPDX-License-Identifier: Apache-2.0
// Mistakes made with real recordings, and none found where there is none.
#include "tools/setup_check/setup_check.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/common/error.hpp"
#include "tools/setup_check/rigid_comparison.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace setup_check_test {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;

Recording ur5_recording(const std::string& name = "Movement_No6_Acc_slow_Verify_Model") {
    return read_recording(DFDYN_TEST_DATA_DIR "/ur5_kufieta/" + name + ".csv",
                          {.joint_count = 6, .outputs = OutputKind::motor_current});
}

/// The torques of the rigid body, with friction where `friction` > 0, along a measured motion.
Recording torques_of(const Robot& robot, Recording recording, double friction) {
    const RecordedMotion recorded = recorded_motion({&recording, 1}, {6, 3});
    const RobotMotion& motion = recorded.motion;
    const Eigen::MatrixXd torque = nominal_outputs(robot, OutputKind::joint_torque, motion) +
                                   friction * (motion.velocity.array() * 20).tanh().matrix();
    const std::size_t first = 6; // rows without a whole window are left out
    recording.output.names = joint_names("tau", 6);
    for (Eigen::Index row = 0; row < torque.rows(); ++row) {
        for (Eigen::Index joint = 0; joint < 6; ++joint) {
            recording.output
                .values[6 * (static_cast<std::size_t>(row) + first) + static_cast<std::size_t>(joint)] =
                torque(row, joint);
        }
    }
    return recording;
}

void change_outputs(Recording& recording, const std::function<void(double*)>& change) {
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        change(recording.output.values.data() + row * recording.output.names.size());
    }
}

void change_positions(Recording& recording, const std::function<void(double*)>& change) {
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        change(recording.position.values.data() + row * recording.joint_count());
    }
}

std::string refusal(const Recording& recording, OutputKind kind, const Robot* robot,
                    const std::vector<double>& constants = {}) {
    try {
        refuse_mistakes(check_setup({&recording, 1}, kind, robot, constants));
    } catch (const InputError& error) {
        CHECK_THAT(error.what(), StartsWith(recording.source + ": "));
        CHECK_THAT(error.what(), ContainsSubstring("--no-setup-check"));
        return error.what();
    }
    return "";
}

TEST_CASE("no recording of the UR5 raises a false alarm, with and without a robot") {
    const Robot robot = dfdyn::tests::ur5();
    for (const char* name : {"Movement_No3_Acc", "Movement_No5_Acc_slow_no_disturbance",
                             "Movement_No6_Acc_slow_Verify_Model", "Movement_No7_Acc_slow_Verify_Model_short",
                             "Movement_No7_Acc_slow_Verify_Model_short_with_disturbance",
                             "Movement_No9_Singularity_Free_NoDist"}) {
        CAPTURE(name);
        const Recording recording = ur5_recording(name);
        CHECK(check_setup({&recording, 1}, OutputKind::motor_current, nullptr, {}).empty());
        CHECK(refusal(recording, OutputKind::motor_current, &robot) == "");
        CHECK(refusal(recording, OutputKind::motor_current, &robot, std::vector<double>(6, 10)) == "");
    }
}

TEST_CASE("classic mistakes with a real recording of currents are refused with what to do") {
    const Robot arm = dfdyn::tests::ur5();
    const Robot* const robot = GENERATE_REF(static_cast<const Robot*>(nullptr), &arm);
    CAPTURE(robot != nullptr);
    Recording recording = ur5_recording();
    SECTION("degrees") {
        change_positions(recording, [](double* q) {
            for (int i = 0; i < 6; ++i) {
                q[i] *= 180 / std::numbers::pi;
            }
        });
        CHECK_THAT(refusal(recording, OutputKind::motor_current, robot), ContainsSubstring("pi/180"));
    }
    SECTION("milliseconds") {
        for (std::size_t row = 0; row < recording.row_count(); ++row) {
            recording.time_s[row] *= 1000;
            recording.time_ns[row] *= 1000;
        }
        CHECK_THAT(refusal(recording, OutputKind::motor_current, robot), ContainsSubstring("milliseconds"));
    }
    SECTION("mA") {
        change_outputs(recording, [](double* current) {
            for (int i = 0; i < 6; ++i) {
                current[i] *= 1000;
            }
        });
        CHECK_THAT(refusal(recording, OutputKind::motor_current, robot), ContainsSubstring("mA"));
    }
    SECTION("a dead channel") {
        change_outputs(recording, [](double* current) { current[3] = 0; });
        CHECK_THAT(refusal(recording, OutputKind::motor_current, robot), ContainsSubstring("column i4"));
    }
    SECTION("wrapped angles") {
        change_positions(recording,
                         [](double* q) { q[0] = std::remainder(q[0] - 1.8, 2 * std::numbers::pi); });
        CHECK_THAT(refusal(recording, OutputKind::motor_current, robot), ContainsSubstring("column q1"));
    }
}

TEST_CASE("with a robot, exchanged currents and currents of the wrong sign are refused") {
    const Robot robot = dfdyn::tests::ur5();
    Recording exchanged = ur5_recording();
    change_outputs(exchanged, [](double* current) { std::swap(current[1], current[4]); });
    CHECK_THAT(refusal(exchanged, OutputKind::motor_current, &robot),
               ContainsSubstring("outputs 2 and 5 look exchanged"));
    CHECK(refusal(exchanged, OutputKind::motor_current, nullptr) == ""); // nothing shows it
    Recording negative = ur5_recording();
    change_outputs(negative, [](double* current) {
        for (int i = 0; i < 6; ++i) {
            current[i] *= -1;
        }
    });
    CHECK_THAT(refusal(negative, OutputKind::motor_current, &robot), ContainsSubstring("multiply by -1"));
}

TEST_CASE("with a robot, torques in mN·m, a single wrong sign and gravity upside down are told apart") {
    const Robot robot = dfdyn::tests::ur5();
    const Recording clean = torques_of(robot, ur5_recording(), 2);
    CHECK(refusal(clean, OutputKind::joint_torque, &robot) == "");
    Recording thousandths = clean;
    change_outputs(thousandths, [](double* torque) {
        for (int i = 0; i < 6; ++i) {
            torque[i] *= 100; // N·cm
        }
    });
    CHECK_THAT(refusal(thousandths, OutputKind::joint_torque, &robot), ContainsSubstring("another unit"));
    Recording one = clean;
    change_outputs(one, [](double* torque) { torque[1] *= -1; });
    CHECK_THAT(refusal(one, OutputKind::joint_torque, &robot),
               ContainsSubstring("output tau2: ") && ContainsSubstring("multiply by -1"));
    Robot ceiling = robot;
    ceiling.gravity = -ceiling.gravity;
    const Recording hanging = torques_of(ceiling, ur5_recording(), 2);
    CHECK(refusal(hanging, OutputKind::joint_torque, &ceiling) == "");
    CHECK_THAT(refusal(hanging, OutputKind::joint_torque, &robot), ContainsSubstring("--gravity"));
}

} // namespace setup_check_test
