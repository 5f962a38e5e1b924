// SPDX-License-Identifier: Apache-2.0
// A real UR5 that is undisturbed for two minutes and is then pushed by a person.
#include "tools/model/run_time/frozen_estimator.hpp"
#include "tools/monitor/monitored_estimator.hpp"
#include "tools/replay/contacts/contact_estimator.hpp"
#include "tools/replay/contacts/contact_limits.hpp"
#include "tools/replay/contradiction.hpp"
#include "tools/replay/replay.hpp"
#include "tools/robot/urdf/read_robot.hpp"
#include "tools/training/model_training.hpp"

#include "tests/support/catch.hpp"
#include "tools/model/structure.hpp"

#include <algorithm>

namespace {

using namespace dfdyn::tools;

Robot ur5() {
    ReadRobotOptions options;
    options.tip = "ee_link";
    return read_robot(std::string(DFDYN_TEST_DATA_DIR) + "/robots/ur5/ur5_robot.urdf", options);
}

Recording recording(const std::string& name) {
    ReadOptions options;
    options.joint_count = 6;
    options.outputs = OutputKind::motor_current;
    return read_recording(std::string(DFDYN_TEST_DATA_DIR) + "/ur5_kufieta/Movement_" + name + ".csv",
                          options);
}

/// Rigid body and friction, as `dfdyn train` computes them with the options in docs/guide/monitor.md.
TrainedModel trained(const Recording& data, const Robot& robot) {
    ModelTraining training;
    training.options.model = &structures::P;
    training.options.input = InputKind::DFSR;
    training.options.lags = 12;
    training.options.likelihood_rows = 600;
    training.options.starts = 3;
    training.options.forgetting_factor = 0.9999;
    training.physics = RobotPhysics{
        robot, {"viscous_friction", "coulomb_friction", "rotor_inertia", "torque_offset"}, 0.05, {}};
    const std::vector<Recording> recordings{data};
    TrainedModel model =
        train_model(prepare_training(recordings, training), OutputKind::motor_current, training, {}).model;
    calibrate_innovation_limit(model, recordings);
    return model;
}

} // namespace

TEST_CASE("a real arm's monitor is silent for two minutes and then finds three of five pushes", "[monitor]") {
    const Robot robot = ur5();
    const Recording first = recording("No6_Acc_slow_Verify_Model");
    const TrainedModel model = trained(first, robot);
    const auto estimator = monitored(make_estimator(model, false), monitor_setup(model, &robot, "test"));
    const auto changes_in = [&](const Recording& one) {
        const auto replayed = replay(*estimator, std::span(&model, 1), one, 0, [](std::size_t) {});
        std::vector<double> onsets;
        for (const NamedChange& change : estimator->take_changes()) {
            onsets.push_back(replayed.clock_origin_s + 1e-9 * static_cast<double>(change.onset_ns));
        }
        return onsets;
    };
    CHECK(changes_in(first).empty());
    CHECK(changes_in(recording("No7_Acc_slow_Verify_Model_short")).empty());
    const std::vector<double> onsets =
        changes_in(recording("No7_Acc_slow_Verify_Model_short_with_disturbance"));
    CAPTURE(onsets);
    REQUIRE(onsets.size() == 3);
    CHECK(onsets[0] == Approx(8.4).margin(0.4)); // the pushes are at 8.5, 11.6, 14.0, 15.8 and 18.8 s
    CHECK(onsets[1] == Approx(11.7).margin(0.4));
    CHECK(onsets[2] == Approx(15.7).margin(0.4));
}

namespace {

/// Start of each contact that is detected in a recording, in its own time.
std::vector<double> contact_starts(const TrainedModel& model, bool learning, const std::string& name) {
    auto estimator = make_estimator(model, false);
    const auto detector =
        with_contacts(learning ? std::move(estimator) : frozen(std::move(estimator)), model.contact);
    const auto replayed = replay(*detector, std::span(&model, 1), recording(name), 0, [](std::size_t) {});
    std::vector<double> starts;
    for (const DetectedContact& contact : detector->take_contacts()) {
        CHECK_FALSE(contact.persistent);
        starts.push_back(replayed.clock_origin_s + 1e-9 * static_cast<double>(contact.start_ns));
    }
    return starts;
}

/// A push on the difference of joint 2's current, mean over 0.2 s, to the undisturbed run of the same
/// commands.
struct Push {
    double onset_s = 0; ///< it exceeds half of `shown`, and remains above until it is shown
    double shown_s = 0; ///< it exceeds 1 A
};

std::vector<Push> pushes_of(const std::string& undisturbed, const std::string& pushed) {
    const Recording without = recording(undisturbed);
    const Recording with = recording(pushed);
    constexpr std::size_t half = 12;
    constexpr double shown = 1; // A
    constexpr double apart_s = 0.5;
    std::vector<Push> pushes;
    double onset_s = 0;
    double last_s = -1;
    const std::size_t rows = std::min(without.row_count(), with.row_count());
    for (std::size_t row = half; row + half < rows; ++row) {
        double sum = 0;
        for (std::size_t i = row - half; i <= row + half; ++i) {
            sum += with.output.row(i)[1] - without.output.row(i)[1];
        }
        const double size = std::abs(sum) / (2 * half + 1);
        onset_s = size > shown / 2 ? onset_s : with.time_s[row];
        if (size > shown) {
            if (last_s < 0 || with.time_s[row] - last_s > apart_s) {
                pushes.push_back({onset_s, with.time_s[row]});
            }
            last_s = with.time_s[row];
        }
    }
    return pushes;
}

} // namespace

TEST_CASE("every push of a person on a real arm is detected within a tenth of a second and nothing else is",
          "[contacts]") {
    const Recording first = recording("No6_Acc_slow_Verify_Model");
    TrainedModel model = trained(first, ur5());
    model.contact = measure_contact_limits(model, std::span(&first, 1));
    for (const bool learning : {false, true}) {
        CAPTURE(learning);
        for (const char* name : {"No3_Acc", "No5_Acc_slow_no_disturbance", "No6_Acc_slow_Verify_Model",
                                 "No7_Acc_slow_Verify_Model_short", "No9_Singularity_Free_NoDist"}) {
            CAPTURE(name);
            CHECK(contact_starts(model, learning, name).empty());
        }
        const auto check = [&](const std::string& undisturbed, const std::string& pushed) {
            const std::vector<Push> pushes = pushes_of(undisturbed, pushed);
            const std::vector<double> contacts = contact_starts(model, learning, pushed);
            CAPTURE(contacts);
            REQUIRE(pushes.size() == 5);
            REQUIRE(contacts.size() == 5);
            for (std::size_t i = 0; i < pushes.size(); ++i) {
                CHECK(contacts[i] >= pushes[i].onset_s - 0.1);
                CHECK(contacts[i] <= pushes[i].shown_s + 0.1);
            }
        };
        check("No7_Acc_slow_Verify_Model_short", "No7_Acc_slow_Verify_Model_short_with_disturbance");
        check("No9_Singularity_Free_NoDist", "No9_Singularity_Free_WDist");
    }
}
