// SPDX-License-Identifier: Apache-2.0
// The regressor of training: its gradient compared with differences, its columns with the robot's torques.
#include "tools/training/physics/robot_regressor.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/text/error.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/model/effects.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <cmath>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::random_robot;
using dfdyn::tests::random_vector;
using dfdyn::tests::uniform;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MotionState random_state(std::mt19937_64& engine, Index joints) {
    const auto draw = [&] { return VectorXd::NullaryExpr(joints, [&] { return uniform(engine, -2, 2); }); };
    return {draw(), draw(), draw()};
}

/// The sum of all elements of gradient ∘ ψ.
double contracted(const Regressor& regressor, const MotionState& state, const MatrixXd& gradient) {
    MatrixXd values;
    regressor.evaluate(state, values);
    return values.cwiseProduct(gradient).sum();
}

void check_gradient(const Regressor& regressor, MotionState state, const MatrixXd& gradient) {
    constexpr double step = 1e-5;
    const RegressorGradient found = regressor.pull_back(state, gradient);
    const auto slope = [&](double& element) {
        const double middle = element;
        element = middle + step;
        const double above = contracted(regressor, state, gradient);
        element = middle - step;
        const double below = contracted(regressor, state, gradient);
        element = middle;
        return (above - below) / (2 * step);
    };
    for (Index i = 0; i < state.position.size(); ++i) {
        CAPTURE(i);
        CHECK(found.velocity[i] == Approx(slope(state.velocity[i])).epsilon(1e-6).margin(1e-7));
        CHECK(found.acceleration[i] == Approx(slope(state.acceleration[i])).epsilon(1e-6).margin(1e-7));
    }
}

} // namespace

TEST_CASE("the gradient with respect to the motion equals differences for both outputs and all effects") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<std::string> of_torques{"viscous_friction", "coulomb_friction", "stribeck_friction",
                                              "rotor_inertia",    "joint_spring",     "torque_offset"};
    for (const int joints : {1, 2, 5}) {
        for (const bool wrench : {false, true}) {
            Robot robot = random_robot(engine, joints);
            robot.sensor = ForceTorqueSensor{};
            robot.sensor->link = 1;
            const ChainModel chain =
                chain_model(robot, wrench ? OutputKind::wrench : OutputKind::joint_torque);
            const auto effects =
                effect_models(wrench ? std::vector<std::string>{"ft_bias"} : of_torques, chain, 0.5);
            const std::vector<double> gains(wrench ? 6 : static_cast<std::size_t>(joints), 0.7);
            const auto regressor = robot_regressor(chain, effects, gains);
            REQUIRE(regressor->columns() ==
                    static_cast<Index>(10 * static_cast<std::size_t>(joints) + effects.size()));
            const MatrixXd gradient = MatrixXd::NullaryExpr(regressor->outputs(), regressor->columns(),
                                                            [&] { return uniform(engine, -1, 1); });
            CAPTURE(joints, wrench);
            check_gradient(*regressor, random_state(engine, joints), gradient);
        }
    }
}

TEST_CASE("columns times the robot's parameters are the gravity torques at rest in units of the output") {
    DFDYN_SEEDED_ENGINE(engine);
    Robot robot = random_robot(engine, 1);
    robot.joints[0].prismatic = false;
    const auto regressor = robot_regressor(chain_model(robot, OutputKind::joint_torque), {}, {0.1});
    const double q = uniform(engine, -3, 3);
    MatrixXd values;
    regressor->evaluate({VectorXd::Constant(1, q), VectorXd::Zero(1), VectorXd::Zero(1)}, values);
    const RobotJoint& joint = robot.joints[0];
    const Eigen::Vector3d first_moment = joint.inertia.segment<3>(1);
    const Eigen::Matrix3d turned =
        joint.placement.linear() * Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
    const double torque = -joint.axis.dot(first_moment.cross(turned.transpose() * robot.gravity));
    const VectorXd parameters = nominal_parameters(robot, OutputKind::joint_torque);
    CHECK((values * parameters)(0, 0) == Approx(0.1 * torque).epsilon(1e-9));
}

TEST_CASE("columns are named with their units in their order") {
    std::mt19937_64 engine(1);
    Robot robot = random_robot(engine, 2);
    for (RobotJoint& joint : robot.joints) {
        joint.prismatic = false;
    }
    const ChainModel chain = chain_model(robot, OutputKind::joint_torque);
    const auto effects = effect_models({"torque_offset", "viscous_friction"}, chain, 0.1);
    const std::vector<std::string> names = column_names(robot, chain, effects);
    REQUIRE(names.size() == 24);
    CHECK(names[1] == "link1 mcx (kg·m)");
    CHECK(names[20] == "joint1 viscous (N·m·s/rad)");
    CHECK(names[23] == "joint2 offset (N·m)");
    ChainModel slide = chain;
    slide.joints[1].prismatic = true;
    CHECK(column_names(robot, slide, effects)[23] == "joint2 offset (N)");
}

TEST_CASE("unknown effects and effects that the outputs cannot show are rejected") {
    std::mt19937_64 engine(1);
    Robot robot = random_robot(engine, 2);
    robot.sensor.reset();
    const ChainModel torques = chain_model(robot, OutputKind::joint_torque);
    CHECK_THROWS_AS(effect_models({"ft_bias"}, torques, 0.1), InputError);
    CHECK_THROWS_AS(effect_models({"magic"}, torques, 0.1), InputError);
    CHECK_THROWS_AS(effect_models({"viscous_friction", "viscous_friction"}, torques, 0.1), InputError);
    CHECK_THROWS_AS(chain_model(robot, OutputKind::wrench), InputError);
    robot.sensor = ForceTorqueSensor{};
    CHECK_THROWS_AS(effect_models({"viscous_friction"}, chain_model(robot, OutputKind::wrench), 0.1),
                    InputError);
}
