// SPDX-License-Identifier: Apache-2.0
#include "tools/training/physics/torque_constants.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/training/physics/robot_regressor.hpp"

#include <cmath>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::random_robot;
using dfdyn::tests::uniform;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double sign_velocity = 0.05;

/// Currents of an arm in random states: the gains times the nominal torques and friction.
TrainingData currents(std::mt19937_64& engine, const Robot& robot, const std::vector<double>& gains) {
    const auto joints = static_cast<Index>(robot.joints.size());
    const auto draw = [&] { return uniform(engine, -2, 2); };
    TrainingData data;
    data.positions = MatrixXd::NullaryExpr(400, joints, draw);
    data.velocities = MatrixXd::NullaryExpr(400, joints, draw);
    data.accelerations = MatrixXd::NullaryExpr(400, joints, draw);
    data.outputs = MatrixXd::Zero(400, joints);
    const auto regressor = robot_regressor(chain_model(robot, OutputKind::joint_torque), {},
                                           std::vector<double>(gains.size(), 1));
    MatrixXd rows;
    for (Index t = 0; t < 400; ++t) {
        regressor->evaluate({data.positions.row(t).transpose(), data.velocities.row(t).transpose(),
                             data.accelerations.row(t).transpose()},
                            rows);
        const VectorXd torque = rows * nominal_parameters(robot, OutputKind::joint_torque);
        for (Index i = 0; i < joints; ++i) {
            const double velocity = data.velocities(t, i);
            const double friction = 0.3 * velocity + 0.8 * std::tanh(velocity / sign_velocity);
            data.outputs(t, i) = gains[static_cast<std::size_t>(i)] * (torque[i] + friction) + 0.2;
        }
    }
    return data;
}

} // namespace

TEST_CASE("gains are recovered from currents with friction and offsets") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = random_robot(engine, 3);
    const std::vector<double> gains{0.11, 0.09, 0.13};
    const auto found = estimate_torque_gains(robot, currents(engine, robot, gains), sign_velocity);
    REQUIRE(found.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(found[i].gain == Approx(gains[i]).epsilon(1e-6));
    }
}

TEST_CASE("a joint without nominal torque gets the median of the other gains") {
    DFDYN_SEEDED_ENGINE(engine);
    Robot robot = random_robot(engine, 4);
    robot.joints.back().inertia *= 1e-9; // a wrist without load, whose current is friction
    TrainingData data = currents(engine, robot, {0.08, 0.1, 0.12, 0.5});
    data.outputs.col(3) += VectorXd::NullaryExpr(400, [&] { return uniform(engine, -0.1, 0.1); });
    const auto found = estimate_torque_gains(robot, data, sign_velocity);
    CHECK(found[1].source == TorqueGain::Source::estimated);
    CHECK(found[3].source == TorqueGain::Source::median);
    CHECK(found[3].gain >= 0.08 * (1 - 1e-6)); // the median of the others, with or without its own gain
    CHECK(found[3].gain <= 0.12 * (1 + 1e-6));
}

TEST_CASE("a gain is accepted between a third of the median and three times the median") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto [gain, own] = GENERATE(
        table<double, bool>({{0.032, false}, {0.034, true}, {0.1, true}, {0.29, true}, {0.31, false}}));
    CAPTURE(gain);
    const Robot robot = random_robot(engine, 3);
    const auto found = estimate_torque_gains(robot, currents(engine, robot, {0.1, 0.1, gain}), sign_velocity);
    CHECK(found[2].gain == Approx(own ? gain : 0.1).epsilon(1e-6));
    CHECK((found[2].source == TorqueGain::Source::estimated) == own);
}

TEST_CASE("currents opposite to the torques at all joints give gains of one") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = random_robot(engine, 2);
    for (const TorqueGain& gain :
         estimate_torque_gains(robot, currents(engine, robot, {-0.1, -0.2}), sign_velocity)) {
        CHECK(gain.gain == 1);
        CHECK(gain.source == TorqueGain::Source::median);
    }
}
