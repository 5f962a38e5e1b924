// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/urdf/read_robot.hpp"

#include "dfdyn/physics/rigid_body.hpp"
#include "tests/support/catch.hpp"

#include <vector>

namespace tools = dfdyn::tools;

namespace {

tools::Robot icub() {
    tools::ReadRobotOptions options;
    options.base = "chest";
    options.tip = "r_hand";
    return tools::read_robot(DFDYN_TEST_DATA_DIR "/robots/icub_right_arm/icub_right_arm.urdf", options);
}

using DynamicWrench = dfdyn::Chain<dfdyn::dynamic, dfdyn::WrenchAtSensor<dfdyn::dynamic>>;

template <class Arm>
Eigen::VectorXd output(const tools::Robot& robot, tools::OutputKind kind, const std::vector<double>& xi) {
    const auto constants = tools::firmware_chain<Arm, double>(robot);
    const auto sizes = tools::firmware_sizes<Arm>(robot);
    const Eigen::VectorXd nominal = tools::nominal_parameters(robot, kind);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> psi(int{sizes.output_count},
                                                                               nominal.size());
    dfdyn::rigid_body_regressor<Arm, double>(constants, sizes, xi.data(), psi.data(),
                                             static_cast<int>(nominal.size()));
    return psi * nominal;
}

} // namespace

TEST_CASE("at rest the sensor carries the weight beyond it") {
    const tools::Robot robot = icub();
    const std::vector<double> at_rest{-0.5, 0, 0, 0.6, 0, 0, 0.3, 0, 0, 0.9, 0, 0};
    const Eigen::VectorXd wrench = output<DynamicWrench>(robot, tools::OutputKind::wrench, at_rest);
    CHECK(wrench.head<3>().norm() == Approx(9.81 * 1.9322575));
    Eigen::Isometry3d sensor = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < 3; ++i) {
        sensor = sensor * robot.joints[i].placement * Eigen::AngleAxisd(at_rest[3 * i], robot.joints[i].axis);
    }
    sensor = sensor * robot.sensor->placement;
    // Child to parent: the weight beyond the sensor pulls it down, along -y of the chest.
    const Eigen::Vector3d weight(0, -9.81 * 1.9322575, 0);
    CHECK((sensor.linear() * wrench.head<3>() - weight).norm() < 1e-12);
}

TEST_CASE("a chain of fixed sizes has the constants of the dynamic one") {
    const tools::Robot robot = icub();
    const std::vector<double> xi{-0.5, 1, 2, 0.6, -1, 3, 0.3, 2, 1, 0.9, 0.5, -1};
    using Fixed = dfdyn::Chain<4, dfdyn::WrenchAtSensor<2>>;
    CHECK(output<Fixed>(robot, tools::OutputKind::wrench, xi) ==
          output<DynamicWrench>(robot, tools::OutputKind::wrench, xi));
    CHECK(output<dfdyn::Chain<4>>(robot, tools::OutputKind::joint_torque, xi) ==
          output<dfdyn::Chain<dfdyn::dynamic>>(robot, tools::OutputKind::joint_torque, xi));
    const auto wrong_joints = [&robot] { return tools::firmware_chain<dfdyn::Chain<3>, float>(robot); };
    CHECK_THROWS_AS(wrong_joints(), std::logic_error);
    using WrongBodies = dfdyn::Chain<4, dfdyn::WrenchAtSensor<3>>;
    const auto wrong_bodies = [&robot] { return tools::firmware_chain<WrongBodies, float>(robot); };
    CHECK_THROWS_AS(wrong_bodies(), std::logic_error);
}

TEST_CASE("the parameters of a wrench are those of the bodies beyond the sensor") {
    tools::Robot robot = icub();
    const Eigen::VectorXd nominal = tools::nominal_parameters(robot, tools::OutputKind::wrench);
    REQUIRE(nominal.size() == 20);
    CHECK(nominal.head<10>() == robot.sensor->inertia_beyond);
    CHECK(nominal.tail<10>() == robot.joints[3].inertia);
    const std::vector<std::string> names = tools::parameter_names(robot, tools::OutputKind::wrench);
    CHECK(names.front() == "link3 m");
    CHECK(names.back() == "link4 Izz");
    CHECK(tools::parameter_units(robot, tools::OutputKind::wrench).size() == 20);
    CHECK(tools::nominal_parameters(robot, tools::OutputKind::joint_torque).size() == 40);
    robot.sensor->link = 0; // a sensor on the base measures everything that moves
    CHECK(tools::nominal_parameters(robot, tools::OutputKind::wrench).size() == 40);
    CHECK(tools::nominal_parameters(robot, tools::OutputKind::wrench).head<10>() == robot.joints[0].inertia);
    robot.sensor.reset();
    CHECK_THROWS_AS(tools::nominal_parameters(robot, tools::OutputKind::wrench), std::logic_error);
}
