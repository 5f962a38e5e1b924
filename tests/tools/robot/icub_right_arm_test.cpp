// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/urdf/read_robot.hpp"

#include "tests/support/catch.hpp"

#include <vector>

namespace tools = dfdyn::tools;

// The numbers below belong to the whole robot's file, not to the cut. A separate program (matrices in plain
// Python) computed them once: it follows the original from `chest` with all joints outside the chain at zero,
// and sums the masses, first moments and inertias of the links.

namespace {

tools::Robot right_arm() {
    tools::ReadRobotOptions options;
    options.base = "chest";
    options.tip = "r_hand";
    return tools::read_robot(DFDYN_TEST_DATA_DIR "/robots/icub_right_arm/icub_right_arm.urdf", options);
}

Eigen::Isometry3d tip_at(const tools::Robot& robot, const std::vector<double>& q) {
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        frame = frame * robot.joints[i].placement * Eigen::AngleAxisd(q[i], robot.joints[i].axis);
    }
    return frame * robot.tip_placement;
}

tools::InertialParameters parameters(const std::vector<double>& values) {
    return Eigen::Map<const tools::InertialParameters>(values.data());
}

} // namespace

TEST_CASE("the cut of the iCub has the joints and limits and sensor of the arm") {
    const tools::Robot robot = right_arm();
    REQUIRE(robot.joints.size() == 4);
    CHECK(robot.joints[0].name == "r_shoulder_pitch");
    CHECK(robot.joints[3].name == "r_elbow");
    CHECK(robot.joints[3].link == "r_elbow_1");
    CHECK(robot.joints[3].upper == Approx(1.8500490071139892));
    CHECK(robot.notes.empty());
    REQUIRE(robot.sensor);
    CHECK(robot.sensor->joint == "r_arm_ft_sensor");
    CHECK(robot.sensor->link == 3);
    CHECK_FALSE(robot.sensor->parent_to_child);
    CHECK((robot.sensor->placement.translation() -
           Eigen::Vector3d(-0.05089730176650909, 0, 0.029167029620599215))
              .norm() < 1e-15);
    CHECK((robot.gravity - Eigen::Vector3d(0, -9.81, 0)).norm() < 1e-12);
}

TEST_CASE("the cut of the iCub moves like the right arm of the whole robot") {
    const tools::Robot robot = right_arm();
    const auto deviation = [&robot](const std::vector<double>& q, const Eigen::Vector3d& position,
                                    const Eigen::Vector3d& first_axis) {
        const Eigen::Isometry3d tip = tip_at(robot, q);
        return (tip.translation() - position).norm() + (tip.linear().col(0) - first_axis).norm();
    };
    CHECK(deviation({0, 0, 0, 0}, {-0.08989809980926496, -0.20856000000000005, 0.0051223000000000004},
                    {0, 0.9659258438815126, 0.2588189794466168}) < 1e-12);
    CHECK(deviation({-0.5, 0.6, 0.3, 0.9}, {-0.17705085176072732, -0.05109096815867852, 0.24184646705257629},
                    {0.20084700117833748, 0.30759980451117774, -0.9300767938091749}) < 1e-12);
    CHECK(deviation({-1.2, 1.4, -0.4, 1.5}, {-0.2967344412381372, 0.23595966848791922, 0.0596705686717519},
                    {0.460910146532864, -0.8822875555688175, 0.09555368183097296}) < 1e-12);
}

TEST_CASE("the cut of the iCub has the mass of the right arm of the whole robot") {
    const tools::Robot robot = right_arm();
    CHECK(robot.sensor->inertia_beyond[0] + robot.joints[3].inertia[0] == Approx(1.9322575).epsilon(1e-12));
    const auto link2 =
        parameters({0.238162, -0.0051000417803196575, 6.471463436137296e-05, -0.00462992511790525,
                    0.0002486504143957074, 1.2737192427805958e-06, -8.88886079318623e-05,
                    0.00040574599629838526, 2.4559176645551134e-06, 0.0002141867511059977});
    const auto link3 =
        parameters({1.104234, -0.06980507197763183, 9.136919400000828e-05, 0.028283498717319284,
                    0.001439709906127903, 9.07044847729642e-06, 0.0020374115744565702, 0.006774119065752447,
                    -1.4620405596839257e-06, 0.005871134853361491});
    const auto beyond =
        parameters({0.745104, -0.06019400737698931, 9.388310400000083e-05, 0.023004316170714474,
                    0.0012197733233580972, 8.777364929500719e-06, 0.001846685186299069, 0.006241557452692829,
                    -1.7649138375100497e-06, 0.005462101787876939});
    const auto link4 =
        parameters({1.1871535, -0.10814439958526827, 0.022020153856850033, 0.010869885029511837,
                    0.001591073426315272, 0.0016969073794980832, 0.0025528234824896204, 0.016918528540216304,
                    -6.721768660487779e-05, 0.016620467945454496});
    CHECK((robot.joints[1].inertia - link2).norm() < 1e-12);
    CHECK((robot.joints[2].inertia - link3).norm() < 1e-12);
    CHECK((robot.joints[3].inertia - link4).norm() < 1e-12);
    CHECK((robot.sensor->inertia_beyond - beyond).norm() < 1e-12);
}
