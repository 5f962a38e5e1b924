// SPDX-License-Identifier: Apache-2.0
// Three motions of one simulated UR5: bristle friction, rotors, a wrong link, and a load in one of the
// motions. The simulator integrates the arm, independently of the fitted columns.
#include "tools/diagnosis/recordings/name_from_recordings.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/recordings/simulated_recording.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/base/recording/columns_matrix.hpp"
#include "tools/base/text/error.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"
#include "tools/diagnosis/recordings/diagnose_recordings.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <algorithm>
#include <cmath>

namespace several_recordings_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;

constexpr std::size_t loaded = 1; ///< recording with a load
const Payload load{0, 2.0, {0.05, 0.02, 0.04}};

/// A scenario of 25 s. Each number gives a different motion.
Scenario scenario_of(const Robot& robot, std::size_t number) {
    constexpr std::array highest_hz{0.6, 0.3, 0.45};
    Scenario scenario = read_scenario(DFDYN_TEST_DATA_DIR "/scenarios/ur5_multisine.json", robot);
    scenario.seed = 100 * seed() + number;
    scenario.recording.samples = 3125;
    std::get<MultisineTask>(scenario.task).highest_hz = highest_hz[number];
    return scenario;
}

/// Three motions. `wrong_link`: the forearm is 1 kg heavier, with its centre displaced by 15 cm and 5 cm.
std::vector<Recording> motions(const Robot& robot, bool with_load, bool wrong_link) {
    std::vector<Recording> recordings;
    for (std::size_t number = 0; number < 3; ++number) {
        Scenario scenario = scenario_of(robot, number);
        if (with_load && number == loaded) {
            scenario.payloads = {load};
        }
        if (wrong_link) {
            scenario.robot_errors.links = {{2, 1, {0.15, 0, 0.05}}};
        }
        recordings.push_back(
            simulated_recording(robot, scenario, "motion" + std::to_string(number) + ".csv"));
    }
    return recordings;
}

SeveralRecordings answer_of(const Robot& robot, const std::vector<Recording>& recordings, bool loads_differ) {
    return fit_recordings(robot, recordings, {}, loads_differ);
}

TEST_CASE("a wrong link and a load in one of three recordings are distinguished, with friction and rotors "
          "within their intervals") {
    INFO("DFDYN_TEST_SEED=" << seed());
    const Robot robot = ur5();
    const std::vector<Recording> recordings = motions(robot, true, true);
    const SeveralRecordings several = answer_of(robot, recordings, true);
    REQUIRE(several.fitted());
    REQUIRE(several.answer.loads.size() == 1);
    const RecordingLoad& found = several.answer.loads.front();
    CHECK(found.recording == loaded);
    const double deviation = std::sqrt(found.covariance(0, 0));
    CHECK(std::abs(found.parameters[0] - load.mass) < std::max(3 * deviation, 0.05));
    CHECK(deviation < 0.4);
    for (Index axis = 0; axis < 3; ++axis) {
        const double moment = load.mass * load.centre[axis];
        CHECK(std::abs(found.parameters[1 + axis] - moment) <
              4 * std::sqrt(found.covariance(1 + axis, 1 + axis)));
    }
    REQUIRE_FALSE(several.answer.wrong_links.empty());
    CHECK(several.answer.wrong_links.front().body == 2);

    const PooledFit& fit = several.answer.fit;
    const Index links = 60;
    int held = 0;
    for (Index joint = 0; joint < 6; ++joint) {
        const Eigen::Vector3d truth =
            joint < 3 ? Eigen::Vector3d(1.5, 8, 8) : Eigen::Vector3d(0.5, 2, 2); // rotor, viscous, dry
        for (Index term = 1; term <= 3; ++term) {
            const Index at = links + terms_of_joint * joint + term;
            const double reach = 1.96 * std::hypot(std::sqrt(fit.covariance(at, at)), fit.spread[at]);
            CHECK(reach < truth[term - 1]);
            held += std::abs(fit.value[at] - truth[term - 1]) < reach ? 1 : 0;
        }
    }
    CHECK(held >= 16); // of 18
}

TEST_CASE("recordings with times in ms are refused before loads are sought in them") {
    const Robot robot = ur5();
    std::vector<Recording> recordings = motions(robot, false, false);
    for (Recording& one : recordings) {
        for (std::size_t row = 0; row < one.row_count(); ++row) {
            one.time_s[row] *= 1000;
            one.time_ns[row] *= 1000;
        }
    }
    const DiagnosisWork work = diagnose_recordings(robot, recordings, {}, true);
    CHECK(refused(work.diagnosis));
    REQUIRE_FALSE(work.diagnosis.suspicions.empty());
    CHECK(work.diagnosis.suspicions.front().code == "time_unit");
}

TEST_CASE("no load is named without one, and the subtracted torque is the load's") {
    INFO("DFDYN_TEST_SEED=" << seed());
    const Robot robot = ur5();
    const std::vector<Recording> empty = motions(robot, false, false);
    CHECK(answer_of(robot, empty, true).answer.loads.empty());
    CHECK(answer_of(robot, empty, true).answer.wrong_links.empty());

    std::vector<Recording> carried = motions(robot, true, false);
    for (const RecordingLoad& one : answer_of(robot, carried, false).answer.loads) {
        CHECK_FALSE(one.recording.has_value()); // `loads_differ` is false
    }
    const SeveralRecordings several = answer_of(robot, carried, true);
    REQUIRE(several.answer.loads.size() == 1);
    CHECK(several.answer.wrong_links.empty());
    const Eigen::MatrixXd before = columns_matrix(carried[loaded].output);
    take_loads_off(carried, robot, several, OutputKind::joint_torque);
    const Eigen::MatrixXd taken = before - columns_matrix(carried[loaded].output);
    const MeasuredMotion motion = measured_motion(carried[loaded]);
    const DiagnosisSignals signals = diagnosis_signals(robot, OutputKind::joint_torque, motion);
    const InertialParameters body =
        moved(body_parameters(load.mass, load.centre, Eigen::Matrix3d::Zero()), robot.tip_placement);
    const Eigen::MatrixXd torque = signals.of_body(5, body);
    CHECK((taken.topRows(torque.rows()) - torque).norm() < 0.15 * torque.norm());
}

TEST_CASE("a load in all recordings is one common load") {
    INFO("DFDYN_TEST_SEED=" << seed());
    const Robot robot = ur5();
    std::vector<Recording> recordings;
    for (std::size_t number = 0; number < 3; ++number) {
        Scenario scenario = scenario_of(robot, number);
        scenario.payloads = {load};
        recordings.push_back(
            simulated_recording(robot, scenario, "motion" + std::to_string(number) + ".csv"));
    }
    for (const bool loads_differ : {false, true}) {
        const SeveralRecordings several = answer_of(robot, recordings, loads_differ);
        REQUIRE(several.answer.loads.size() == 1);
        const RecordingLoad& found = several.answer.loads.front();
        CHECK_FALSE(found.recording.has_value());
        CHECK(found.parameters[0] ==
              Approx(load.mass).margin(std::max(3 * std::sqrt(found.covariance(0, 0)), 0.05)));
        CHECK(several.answer.wrong_links.empty());
    }
}

TEST_CASE("a single recording and wrenches have no common fit") {
    const Robot robot = ur5();
    const Recording one = simulated_recording(robot, scenario_of(robot, 0), "one.csv");
    CHECK_FALSE(answer_of(robot, {one}, false).fitted());
    DiagnosisOptions wrench;
    wrench.outputs = OutputKind::wrench;
    CHECK_FALSE(fit_recordings(robot, {one, one}, wrench, false).fitted());
}

TEST_CASE("a recording of two rows, or with rows 1 s apart, has no part in the common fit") {
    const Robot robot = ur5();
    const Recording one = simulated_recording(robot, scenario_of(robot, 0), "one.csv");
    for (const int rows : {2, 20}) {
        CAPTURE(rows);
        Recording slow;
        slow.source = "slow.csv";
        slow.position.names = one.position.names;
        slow.output.names = one.output.names;
        for (int row = 0; row < rows; ++row) {
            append_row(slow, row, Eigen::VectorXd::Constant(6, 0.01 * row), Eigen::VectorXd::Zero(6));
        }
        CHECK(answer_of(robot, {one, slow}, false).pooled == std::vector<std::size_t>{0});
        if (rows < 4) {
            CHECK_THROWS_AS(measured_motion(slow), InputError);
        }
    }
}

/// Adds dry friction to the recording: `part` of each joint's in the scenario.
Recording with_more_dry_friction(Recording recording, double part) {
    const std::vector<double> position = recording.position.values;
    for (std::size_t value = 6; value < position.size(); ++value) {
        const double dry = value % 6 < 3 ? 8 : 2;
        recording.output.values[value] += std::copysign(part * dry, position[value] - position[value - 6]);
    }
    return recording;
}

TEST_CASE("the same recording twice gives no difference, and a changed friction gives one") {
    INFO("DFDYN_TEST_SEED=" << seed());
    constexpr double expected_spread = 0.05; // prior spread of dry friction
    constexpr double more = 0.3;
    const Robot robot = ur5();
    const Recording one = simulated_recording(robot, scenario_of(robot, 0), "one.csv");
    const PooledFit twice = answer_of(robot, {one, one}, false).answer.fit;
    const PooledFit apart = answer_of(robot, {one, with_more_dry_friction(one, more)}, false).answer.fit;
    for (Index joint = 0; joint < 6; ++joint) {
        CAPTURE(joint);
        const Index dry = 60 + terms_of_joint * joint + 3;
        const double truth = joint < 3 ? 8 : 2;
        CHECK(twice.value[dry] == Approx(truth).epsilon(0.25));
        CHECK(std::abs(twice.difference[0][dry]) < 1e-3 * truth);
        CHECK(twice.spread[dry] < 0.7 * expected_spread * truth);
        CHECK(apart.spread[dry] > 1.5 * expected_spread * truth);
        const double found = apart.difference[1][dry] - apart.difference[0][dry];
        CHECK(found == Approx(more * truth).epsilon(0.3));
    }
}

} // namespace several_recordings_test
