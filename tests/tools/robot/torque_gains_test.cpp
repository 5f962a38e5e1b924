// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/identification/torque_gains.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/support/simulated_currents.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/training/physics/robot_regressor.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

namespace torque_gains_test {

using namespace dfdyn::tools;
using dfdyn::tests::random_robot;
using dfdyn::tests::uniform;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double sign_velocity = 0.05;

/// Currents of an arm in random states: the gains times the nominal torques and friction.
RecordedMotion currents(std::mt19937_64& engine, const Robot& robot, const std::vector<double>& gains) {
    const auto joints = static_cast<Index>(robot.joints.size());
    const auto draw = [&] { return uniform(engine, -2, 2); };
    RecordedMotion data;
    RobotMotion& motion = data.motion;
    motion.position = MatrixXd::NullaryExpr(400, joints, draw);
    motion.velocity = MatrixXd::NullaryExpr(400, joints, draw);
    motion.acceleration = MatrixXd::NullaryExpr(400, joints, draw);
    data.outputs = MatrixXd::Zero(400, joints);
    const auto regressor = robot_regressor(chain_model(robot, OutputKind::joint_torque), {},
                                           std::vector<double>(gains.size(), 1));
    MatrixXd rows;
    for (Index t = 0; t < 400; ++t) {
        regressor->evaluate({motion.position.row(t).transpose(), motion.velocity.row(t).transpose(),
                             motion.acceleration.row(t).transpose()},
                            rows);
        const VectorXd torque = rows * nominal_parameters(robot, OutputKind::joint_torque);
        for (Index i = 0; i < joints; ++i) {
            const double velocity = motion.velocity(t, i);
            const double friction = 0.3 * velocity + 0.8 * std::tanh(velocity / sign_velocity);
            data.outputs(t, i) = gains[static_cast<std::size_t>(i)] * (torque[i] + friction) + 0.2;
        }
    }
    return data;
}

void check_recovered(const Robot& robot, const RecordedMotion& data, const std::vector<double>& gains) {
    const auto found = estimate_torque_gains(robot, data, sign_velocity);
    REQUIRE(found.size() == gains.size());
    for (std::size_t i = 0; i < gains.size(); ++i) {
        CHECK(found[i].gain == Approx(gains[i]).epsilon(1e-6));
    }
}

TEST_CASE("gains are recovered from currents with friction and offsets") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = random_robot(engine, 3);
    const std::vector<double> gains{0.11, 0.09, 0.13};
    check_recovered(robot, currents(engine, robot, gains), gains);
}

TEST_CASE("rotors do not change the gains") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = random_robot(engine, 3);
    const std::vector<double> gains{0.11, 0.09, 0.13};
    RecordedMotion data = currents(engine, robot, gains);
    data.outputs += 0.2 * data.motion.acceleration;
    check_recovered(robot, data, gains);
}

TEST_CASE("a weight that friction bears at rest does not change the gains") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = random_robot(engine, 3);
    const std::vector<double> gains{0.11, 0.09, 0.13};
    RecordedMotion data = currents(engine, robot, gains);
    const RecordedMotion rest = currents(engine, robot, gains);
    data.motion.velocity.topRows(200).setZero();
    data.outputs.topRows(200) = 0.3 * rest.outputs.topRows(200);
    check_recovered(robot, data, gains);
}

TEST_CASE("torque constants of a simulated arm are found within 10 % for its arm and 35 % for its wrist") {
    const Robot robot = dfdyn::tests::ur5();
    Scenario scenario = read_scenario(DFDYN_TEST_DATA_DIR "/scenarios/ur5_multisine.json", robot);
    scenario.seed = dfdyn::tests::seed();
    const Recording recording = dfdyn::tests::simulated_currents(robot, scenario);
    const auto found = estimate_torque_gains(
        robot, recorded_motion({&recording, 1}, rigid_body_window({&recording, 1})), sign_velocity);
    for (std::size_t joint = 0; joint < found.size(); ++joint) {
        CAPTURE(joint, dfdyn::tests::seed());
        const double truth = (*scenario.torque_sensor.torque_constant)[static_cast<Index>(joint)];
        CHECK(1 / found[joint].gain == Approx(truth).epsilon(joint < 3 ? 0.1 : 0.35));
    }
}

TEST_CASE("a joint without nominal torque gets the median of the other gains") {
    DFDYN_SEEDED_ENGINE(engine);
    Robot robot = random_robot(engine, 4);
    robot.joints.back().inertia *= 1e-9; // a wrist without load, whose current is friction
    RecordedMotion data = currents(engine, robot, {0.08, 0.1, 0.12, 0.5});
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

TEST_CASE("given torque constants give their inverses, and the recording is not read") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = random_robot(engine, 2);
    const auto unread = []() -> std::vector<TorqueGain> { throw std::logic_error("read"); };
    const auto gains = torque_gains(robot, OutputKind::motor_current, std::vector{8.0, 10.0}, unread);
    CHECK(output_gains(gains, 2) == std::vector{1 / 8.0, 1 / 10.0});
    CHECK(gains[0].source == TorqueGain::Source::given);
    CHECK_THROWS_WITH(torque_gains(robot, OutputKind::motor_current, std::vector{8.0}, unread),
                      "--torque-constants: expected 2, one per joint, found 1");
}

TEST_CASE("estimated torque constants that no motor has are rejected") {
    using Source = TorqueGain::Source;
    const auto check = [](double gain, Source source) {
        check_estimated_gains(std::vector<TorqueGain>{{0.1, Source::estimated}, {gain, source}});
    };
    CHECK_NOTHROW(check(2e-4, Source::estimated)); // 5000 N m/A
    CHECK_NOTHROW(check(3000, Source::median));    // a small servo in mA
    CHECK_NOTHROW(check(3.4e-5, Source::given));
    CHECK_NOTHROW(check_estimated_gains({}));
    CHECK_THROWS_WITH(check(4e-5, Source::estimated),
                      "torque constants estimated with the robot's masses: expected 0.0001 to 10000 N m/A, "
                      "found 10, 25000: check the robot and the unit of the currents (--units i=mA), or "
                      "give --torque-constants");
    CHECK_THROWS(check(2e4, Source::median));
}

TEST_CASE("without torque constants the gains are estimated, and other outputs have a gain of one") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = random_robot(engine, 2);
    const RecordedMotion data = currents(engine, robot, {0.11, 0.09});
    const auto estimate = [&] { return estimate_torque_gains(robot, data, sign_velocity); };
    const auto gains = torque_gains(robot, OutputKind::motor_current, {}, estimate);
    REQUIRE(gains.size() == 2);
    CHECK(gains[1].gain == estimate()[1].gain);
    CHECK(output_gains(torque_gains(robot, OutputKind::joint_torque, {}, estimate), 2) ==
          std::vector{1.0, 1.0});
}

} // namespace torque_gains_test
