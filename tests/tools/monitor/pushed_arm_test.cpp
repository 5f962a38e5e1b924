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

/// How rigid body and friction are trained.
struct Recipe {
    InputKind input;
    int lags;
    std::vector<std::string> effects;
    PhysicsMotion motion = PhysicsMotion::free;
};

/// With the options in docs/guide/monitor.md.
const Recipe monitor_recipe{InputKind::DFSR,
                            12,
                            {"viscous_friction", "coulomb_friction", "rotor_inertia", "torque_offset"},
                            PhysicsMotion::of_input};

/// As `dfdyn train` computes the model.
TrainedModel trained(const Recording& data, const Robot& robot, const Recipe& recipe) {
    ModelTraining training;
    training.options.model = &structures::P;
    training.options.input = recipe.input;
    training.options.lags = recipe.lags;
    training.options.likelihood_rows = 600;
    training.options.starts = 3;
    training.options.forgetting_factor = 0.9999;
    training.options.physics.motion = recipe.motion;
    training.physics = RobotPhysics{robot, recipe.effects, std::nullopt, {}};
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
    const TrainedModel model = trained(first, robot, monitor_recipe);
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
        with_contacts(learning ? std::move(estimator) : frozen(std::move(estimator)), {model.contact});
    const auto replayed = replay(*detector, std::span(&model, 1), recording(name), 0, [](std::size_t) {});
    std::vector<double> starts;
    for (const DetectedContact& contact : detector->take_contacts()) {
        CHECK_FALSE(contact.persistent);
        starts.push_back(replayed.clock_origin_s + 1e-9 * static_cast<double>(contact.start_ns));
    }
    return starts;
}

/// Two runs of the same commands, the second with a person who pushes.
struct PairedRuns {
    std::string undisturbed, pushed;
    std::size_t joint;          ///< index of the joint whose current shows the pushes
    std::size_t later_rows = 0; ///< by which the undisturbed run is later
};

/// A push on the difference of the paired currents, mean over 0.2 s.
struct Push {
    double onset_s = 0; ///< the difference exceeds half of `shown`, and remains above until it is shown
    double shown_s = 0; ///< it exceeds 1 A
    double end_s = 0;   ///< it is no longer above half of `shown`
};

struct PairedPushes {
    std::vector<Push> pushes;
    double end_s = 0; ///< time at which one of the runs has ended
};

PairedPushes pushes_of(const PairedRuns& runs) {
    const Recording without = recording(runs.undisturbed);
    const Recording with = recording(runs.pushed);
    constexpr std::size_t half = 12;
    constexpr double shown = 1; // A
    PairedPushes found;
    double onset_s = 0;
    bool pushed = false;
    const std::size_t rows = std::min(without.row_count() - runs.later_rows, with.row_count());
    for (std::size_t row = half; row + half < rows; ++row) {
        double sum = 0;
        for (std::size_t i = row - half; i <= row + half; ++i) {
            sum += with.output.row(i)[runs.joint] - without.output.row(i + runs.later_rows)[runs.joint];
        }
        const double size = std::abs(sum) / (2 * half + 1);
        found.end_s = with.time_s[row];
        if (size > shown && !pushed) {
            found.pushes.push_back({onset_s, found.end_s});
            pushed = true;
        }
        if (pushed) {
            found.pushes.back().end_s = found.end_s;
        }
        if (size <= shown / 2) {
            onset_s = found.end_s;
            pushed = false;
        }
    }
    return found;
}

/// Returns the numbers of the pushes without a contact from 0.1 s before their onset to 0.1 s after they are
/// shown. Every contact while both runs last must begin during a push.
std::vector<std::size_t> missed_pushes(const PairedPushes& paired, std::vector<double> contacts) {
    std::erase_if(contacts, [&](double start) { return start > paired.end_s; });
    CAPTURE(contacts);
    const auto begins_between = [&](double first, double last) {
        return std::ranges::count_if(contacts, [=](double start) { return start >= first && start <= last; });
    };
    std::vector<std::size_t> missed;
    std::ptrdiff_t during_pushes = 0;
    for (std::size_t i = 0; i < paired.pushes.size(); ++i) {
        const Push& push = paired.pushes[i];
        during_pushes += begins_between(push.onset_s - 0.1, push.end_s + 0.1);
        if (begins_between(push.onset_s - 0.1, push.shown_s + 0.1) == 0) {
            missed.push_back(i);
        }
    }
    CHECK(during_pushes == std::ssize(contacts));
    return missed;
}

} // namespace

TEST_CASE("most pushes of a person on a real arm are detected within a tenth of a second, nothing else",
          "[contacts]") {
    const Robot robot = ur5();
    const Recording first = recording("No6_Acc_slow_Verify_Model");
    const std::vector<std::string> friction{"viscous_friction", "coulomb_friction", "torque_offset"};
    std::vector<std::string> with_rotors = friction;
    with_rotors.emplace_back("rotor_inertia");
    // Small differences between models decide about the weakest push.
    for (const Recipe& recipe :
         {Recipe{InputKind::DFR, 10, friction}, Recipe{InputKind::DFR, 10, with_rotors},
          Recipe{InputKind::DFR, 10, with_rotors, PhysicsMotion::of_input},
          Recipe{InputKind::DFR, 10, friction, PhysicsMotion::of_input}}) {
        TrainedModel model = trained(first, robot, recipe);
        model.contact = measure_contact_limits(model, std::span(&first, 1));
        for (const bool learning : {false, true}) {
            CAPTURE(recipe.effects.size(), static_cast<int>(recipe.motion), learning);
            for (const char* name : {"No3_Acc", "No5_Acc_slow_no_disturbance", "No6_Acc_slow_Verify_Model",
                                     "No7_Acc_slow_Verify_Model_short", "No8_Singularity_Free_1",
                                     "No9_Singularity_Free_NoDist"}) {
                CAPTURE(name);
                CHECK(contact_starts(model, learning, name).empty());
            }
            const auto missed = [&](const PairedRuns& runs, std::size_t count) {
                const PairedPushes paired = pushes_of(runs);
                REQUIRE(paired.pushes.size() == count);
                return missed_pushes(paired, contact_starts(model, learning, runs.pushed));
            };
            const std::vector<std::size_t> in_first = missed(
                {"No7_Acc_slow_Verify_Model_short", "No7_Acc_slow_Verify_Model_short_with_disturbance", 1},
                5);
            CHECK((in_first.empty() || in_first == std::vector<std::size_t>{4}));
            CHECK(missed({"No9_Singularity_Free_NoDist", "No9_Singularity_Free_WDist", 1}, 5).empty());
            // Limits are wide for 0.7 s after a reversal; there the third and the fourth push begin.
            const std::size_t most_missed = recipe.motion == PhysicsMotion::of_input ? 4 : learning ? 1 : 3;
            CHECK(missed({"No5_Acc_slow_no_disturbance", "No5_Acc_slow_w_disturbance", 0, 12}, 7).size() <=
                  most_missed);
        }
    }
}
