// SPDX-License-Identifier: Apache-2.0
// The weight of an arm at rest, by a rigid body learned from its motion alone.
#include "tools/training/model_training.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/support/simulated_currents.hpp"
#include "tools/model/run_time/runtime_estimator.hpp"
#include "tools/model/structure.hpp"
#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <cmath>
#include <span>
#include <vector>

namespace learned_weight_test {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::VectorXd;

constexpr int rows_at_rest = 20; // more than the window

/// Returns the outputs that the model predicts at rest at `position`, without learning.
VectorXd predicted_at_rest(const TrainedModel& model, std::span<const double> position) {
    const auto estimator = make_estimator(model, false);
    Tick tick;
    for (int row = 0; row < rows_at_rest; ++row) {
        const auto time_ns = std::llround(1e9 * row * model.sample_period_s);
        tick = estimator->tick({time_ns, position, {}, {}, {}}, dfdyn::Budget::predict_only());
    }
    REQUIRE(tick.status.predicted());
    return Eigen::Map<const Eigen::VectorXf>(tick.prediction.data(), static_cast<Index>(position.size()))
        .cast<double>();
}

/// Returns the torques that hold the arm at rest, N m.
VectorXd weight(const ArmDynamics& arm, std::span<const double> position) {
    const JointVector rest = JointVector::Zero(arm.joint_count());
    ArmDynamics::Configuration configuration;
    arm.configure(Eigen::Map<const VectorXd>(position.data(), arm.joint_count()), configuration);
    return arm.inverse(configuration, rest, rest);
}

TEST_CASE("the physics learns an arm's weight from its motion alone") {
    const Robot robot = dfdyn::tests::ur5();
    Scenario scenario = read_scenario(DFDYN_TEST_DATA_DIR "/scenarios/ur5_multisine.json", robot);
    scenario.seed = dfdyn::tests::seed();
    const Recording recording = dfdyn::tests::simulated_currents(robot, scenario);
    ModelTraining training;
    training.options.model = &structures::P;
    training.options.likelihood_rows = 300;
    training.options.starts = 1;
    training.options.evaluations_per_start = 60;
    training.options.refinement_evaluations = 0;
    const VectorXd constants = *scenario.torque_sensor.torque_constant;
    training.physics =
        RobotPhysics{robot,
                     {"viscous_friction", "coulomb_friction", "rotor_inertia", "torque_offset"},
                     std::nullopt,
                     std::vector<double>(constants.begin(), constants.end())};
    const TrainedModel model =
        train_model(prepare_training({&recording, 1}, training), OutputKind::motor_current, training, {})
            .model;
    const ArmDynamics arm(robot, JointVector::Zero(6));
    DFDYN_SEEDED_ENGINE(engine);
    VectorXd worst = VectorXd::Zero(6);
    for (int posture = 0; posture < 50; ++posture) {
        const auto position = recording.position.row(engine() % recording.row_count());
        const VectorXd torque = constants.cwiseProduct(predicted_at_rest(model, position));
        worst = worst.cwiseMax((torque - weight(arm, position)).cwiseAbs());
    }
    CAPTURE(worst.transpose());
    CHECK(worst[0] < 0.3); // it turns about the vertical
    CHECK(worst.maxCoeff() < 4);
}

} // namespace learned_weight_test
