// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/identification/base_parameters.hpp"
#include "tools/robot/regressor.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"

#include <limits>

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tools::OutputKind;

namespace {

tools::BaseParameters base_of(const tools::Robot& robot, OutputKind outputs) {
    return tools::find_base_parameters(
        tools::stacked_regressor(robot, outputs, tools::random_motion(robot, 300, 1)));
}

} // namespace

TEST_CASE("arms have the number of base parameters that theory predicts") {
    // Planar arm: two first moments per link if gravity acts, and the inertias about the joints. Without
    // gravity the moments of the first link have no effect.
    CHECK(base_of(dfdyn::tests::planar_arm(9.81), OutputKind::joint_torque).count() == 6);
    CHECK(base_of(dfdyn::tests::planar_arm(0), OutputKind::joint_torque).count() == 4);
    // Six revolute joints, the first vertical, the second and third parallel: 1 + 7 + ... with one first
    // moment fewer for each joint parallel to its predecessor.
    const tools::BaseParameters ur5 = base_of(dfdyn::tests::ur5(), OutputKind::joint_torque);
    CHECK(ur5.count() == 36);
    CHECK(ur5.gap > 1e6);
    // Wrench: all ten parameters of the body that moves with the sensor, and seven for each revolute link
    // after it.
    const tools::BaseParameters wrench = base_of(dfdyn::tests::icub_right_arm(), OutputKind::wrench);
    CHECK(wrench.count() == 17);
    CHECK(wrench.gap > 1e6);
}

TEST_CASE("base parameters explain all outputs in states that were not used to find them") {
    for (const OutputKind outputs : {OutputKind::joint_torque, OutputKind::wrench}) {
        const tools::Robot robot = dfdyn::tests::icub_right_arm();
        const tools::BaseParameters base = base_of(robot, outputs);
        const MatrixXd psi = tools::stacked_regressor(robot, outputs, tools::random_motion(robot, 50, 7));
        const VectorXd parameters = VectorXd::LinSpaced(psi.cols(), -1, 2);
        const VectorXd all = psi * parameters;
        const VectorXd of_base = psi(Eigen::all, base.independent) * (base.combination * parameters);
        CHECK((all - of_base).norm() < 1e-9 * all.norm());
    }
}

TEST_CASE("base parameters are found among dependent and zero and independent columns") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> normal;
    MatrixXd columns = MatrixXd::NullaryExpr(40, 5, [&] { return normal(engine); });
    CHECK(tools::find_base_parameters(columns).count() == 5);
    columns.col(1).setZero();
    columns.col(4) = 1e3 * columns.col(0) - 0.5e3 * columns.col(2);
    const tools::BaseParameters base = tools::find_base_parameters(columns);
    REQUIRE(base.count() == 3);
    const VectorXd parameters = VectorXd::LinSpaced(5, 1, 5);
    CHECK((columns * parameters - columns(Eigen::all, base.independent) * base.combination * parameters)
              .norm() < 1e-8);
    CHECK(tools::find_base_parameters(MatrixXd::Zero(9, 3)).count() == 0);
}

TEST_CASE("a base parameter is named by its linear combination") {
    tools::BaseParameters base;
    base.independent = {0, 3};
    base.combination = MatrixXd{{1, 0.39225, -1, 0}, {0, -2, 0, 1}};
    const std::vector<std::string> names = tools::base_parameter_names(base, {"a", "b", "c", "d"});
    CHECK(names == std::vector<std::string>{"a + 0.392·b - c", "d - 2·b"});
}

TEST_CASE("random states stay within the limits and are deterministic") {
    const tools::Robot robot = dfdyn::tests::icub_right_arm();
    const tools::RobotMotion motion = tools::random_motion(robot, 200, 3);
    for (Eigen::Index i = 0; i < 4; ++i) {
        const tools::RobotJoint& joint = robot.joints[static_cast<std::size_t>(i)];
        CHECK(motion.position.col(i).minCoeff() >= *joint.lower);
        CHECK(motion.position.col(i).maxCoeff() < *joint.upper);
        CHECK(motion.position.col(i).maxCoeff() - motion.position.col(i).minCoeff() >
              0.9 * (*joint.upper - *joint.lower));
    }
    CHECK(tools::random_motion(robot, 200, 3).acceleration == motion.acceleration);
    CHECK(tools::random_motion(robot, 200, 4).acceleration != motion.acceleration);
}
