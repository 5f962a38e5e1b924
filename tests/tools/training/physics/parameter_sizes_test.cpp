// SPDX-License-Identifier: Apache-2.0
#include "tools/training/physics/parameter_sizes.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/base/text/error.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <limits>

namespace parameter_sizes_test {

using namespace dfdyn::tools;
using Eigen::VectorXd;

VectorXd sizes_of(const Robot& robot, const std::vector<std::string>& effects = {}) {
    const ChainModel chain = chain_model(robot, OutputKind::joint_torque);
    return parameter_sizes(robot, chain, effect_models(effects, chain, 0.05));
}

Robot without_masses(Robot robot) {
    for (RobotJoint& joint : robot.joints) {
        joint.inertia.setZero();
    }
    return robot;
}

TEST_CASE("the size of each parameter follows from mass and reach and limits") {
    Robot robot = dfdyn::tests::planar_arm(9.81); // two links of 1 kg, 1 m from joint to joint
    robot.tip_placement.translation() = Eigen::Vector3d(0.6, 0, 0);
    robot.joints[0].effort = 200;
    robot.joints[0].velocity = 4;
    robot.joints[1].effort = 1e6; // a placeholder
    robot.joints[1].velocity = 1e6;
    const VectorXd sizes =
        sizes_of(robot, {"viscous_friction", "coulomb_friction", "rotor_inertia", "torque_offset"});
    REQUIRE(sizes.size() == 28);
    const double weight = 2 * 9.81 * 1.6;
    CHECK(sizes[0] == Approx(2));
    CHECK(sizes[13] == Approx(2 * 1.6));
    CHECK(sizes[19] == Approx(2 * 1.6 * 1.6));
    const VectorXd expected{
        {200 / 4.0, weight, 200, weight, 2 * 1.6 * 1.6, 2 * 1.6 * 1.6, 200, weight}}; // by effect, by joint
    CHECK((sizes.tail(8) - expected).norm() < 1e-9);
}

TEST_CASE("the reach of a link is at least the distance of its centre of mass") {
    Robot robot = dfdyn::tests::planar_arm(9.81);
    robot.joints.resize(1);
    robot.tip_placement.setIdentity();
    robot.joints[0].inertia << 0.5, 0, 0, -0.5 * 0.1, 0.005, 0, 0, 0.005, 0, 0; // 0.5 kg, hanging at 0.1 m
    CHECK(sizes_of(robot)[3] == Approx(0.5 * 0.1));
}

TEST_CASE("the prior deviation of a link's parameter is three tenths of the links beyond its joint") {
    Robot robot = dfdyn::tests::planar_arm(9.81); // two links of 1 kg, 1 m from joint to joint
    robot.tip_placement.translation() = Eigen::Vector3d(0.6, 0, 0);
    const ChainModel chain = chain_model(robot, OutputKind::joint_torque);
    const VectorXd deviations = parameter_deviations(robot, chain, {});
    CHECK(deviations[0] == Approx(0.3 * 2));
    CHECK(deviations[3] == Approx(0.3 * 2 * 1.6));
    CHECK(deviations[9] == Approx(0.3 * 2 * 1.6 * 1.6));
    CHECK(parameter_deviations(without_masses(robot), chain, {})[0] == 1000);
}

TEST_CASE("the last link may carry a tool of a twentieth of the robot's mass") {
    Robot robot = dfdyn::tests::planar_arm(9.81);
    robot.tip_placement.translation() = Eigen::Vector3d(0.6, 0, 0);
    const ChainModel chain = chain_model(robot, OutputKind::joint_torque);
    const VectorXd deviations = parameter_deviations(robot, chain, {});
    const double tool = 0.05 * 2;
    const double reach = 0.6 + 0.05 * 1.6;
    CHECK(deviations[10] == Approx(0.3 + tool));
    CHECK(deviations[13] == Approx(0.3 * 0.6 + tool * reach));
    CHECK(deviations[19] == Approx(0.3 * 0.6 * 0.6 + tool * reach * reach));
}

TEST_CASE("the prior of an offset or a rotor is narrower than the largest plausible value") {
    const Robot robot = dfdyn::tests::planar_arm(9.81);
    const ChainModel chain = chain_model(robot, OutputKind::joint_torque);
    const auto effects = effect_models({"coulomb_friction", "rotor_inertia", "torque_offset"}, chain, 0.05);
    const VectorXd deviations = parameter_deviations(robot, chain, effects);
    const VectorXd sizes = parameter_sizes(robot, chain, effects);
    CHECK(deviations.segment(20, 2) == sizes.segment(20, 2));
    CHECK((deviations.segment(22, 2) - 0.1 * sizes.segment(22, 2)).norm() < 1e-12);
    CHECK((deviations.tail(2) - 0.005 * sizes.tail(2)).norm() < 1e-12);
}

TEST_CASE("the robot's own parameters are those of its file, without effects") {
    const Robot robot = dfdyn::tests::planar_arm(9.81);
    const ChainModel chain = chain_model(robot, OutputKind::joint_torque);
    const VectorXd expected =
        expected_parameters(robot, chain, effect_models({"coulomb_friction"}, chain, 0.05));
    CHECK(expected.head(20) == nominal_parameters(robot, OutputKind::joint_torque));
    CHECK(expected.tail(2).norm() == 0);
}

TEST_CASE("without masses the sizes follow from efforts and without efforts from one tonne") {
    Robot robot = without_masses(dfdyn::tests::planar_arm(9.81));
    CHECK(sizes_of(robot)[0] == 1000);
    robot.joints[1].effort = 9.81;
    CHECK(sizes_of(robot)[0] == Approx(1)); // kg, at a distance of 1 m
}

TEST_CASE("a link without mass cannot be heavier than the whole robot") {
    Robot robot = dfdyn::tests::planar_arm(9.81); // two links of 1 kg
    robot.joints[1].inertia.setZero();
    const ChainModel chain = chain_model(robot, OutputKind::joint_torque);
    CHECK(parameter_deviations(robot, chain, {})[10] == Approx(1 + 0.05)); // and a tool
}

TEST_CASE("the nominal parameters of real robots are within their sizes") {
    for (const Robot& robot : {dfdyn::tests::ur5(), dfdyn::tests::icub_right_arm()}) {
        CAPTURE(robot.name);
        const VectorXd own = nominal_parameters(robot, OutputKind::joint_torque);
        CHECK((own.cwiseAbs().array() <= sizes_of(robot).array()).all());
    }
}

TEST_CASE("a parameter beyond its bound is rejected with its name and value and bound") {
    PhysicsModel physics;
    physics.selected = {1, 3};
    physics.parameter_names = {"link1 mcx (kg·m)", "link1 mcz (kg·m)"};
    physics.column_scale = {0.5, 1e15};
    physics.start.weights = {2, 0.02};
    const VectorXd sizes{{1, 3, 3, 4}};
    CHECK_THROWS_AS(check_parameters(physics, sizes), InputError);
    CHECK_THROWS_WITH(
        check_parameters(physics, sizes),
        Catch::Matchers::StartsWith("trained physics: parameter link1 mcz (kg·m): expected at most 400 in "
                                    "magnitude") &&
            Catch::Matchers::ContainsSubstring("found 2e+13"));
    physics.start.weights = {-600, 4e-13}; // -300 and 400, which are at the bounds
    CHECK_NOTHROW(check_parameters(physics, sizes));
    physics.start.weights[0] = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_AS(check_parameters(physics, sizes), InputError);
}

} // namespace parameter_sizes_test
