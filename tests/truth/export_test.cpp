// SPDX-License-Identifier: Apache-2.0
// Loads exported robots with kdl_parser and urdfdom and compares their joint torques with those of the
// extended model's columns: the regressor of the rigid body, damping and friction.
#include "dfdyn/physics/rigid_body.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/truth/kdl_torques.hpp"
#include "tests/truth/regressor.hpp"
#include "tools/robot/export/robot_export.hpp"

#include <kdl_parser/kdl_parser.hpp>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <string>

namespace {

using namespace dfdyn;
using namespace dfdyn::tests;

tools::RobotExport random_export(std::mt19937_64& engine, int n) {
    tools::RobotExport exported{random_robot(engine, n), {}, {}};
    exported.robot.name = "arm";
    exported.robot.base = "base";
    exported.robot.tip = "tool";
    exported.robot.tip_placement = random_placement(engine);
    for (int i = 0; i < n; ++i) {
        exported.joints.push_back({uniform(engine, 0, 5), uniform(engine, 0, 5), uniform(engine, 0, 1)});
    }
    return exported;
}

/// Torques that a simulator computes from the file: those of its rigid body, damping and friction.
Eigen::VectorXd torques_of_file(const std::string& urdf, const Eigen::VectorXd& xi, double gravity) {
    KDL::Tree tree;
    REQUIRE(kdl_parser::treeFromString(urdf, tree));
    KDL::Chain chain;
    REQUIRE(tree.getChain(tree.getRootSegment()->first, "tool", chain));
    Eigen::VectorXd torques = kdl_torques(chain, KDL::Vector(0, 0, -gravity), xi);
    const auto model = urdf::parseURDF(urdf);
    REQUIRE(model);
    for (Eigen::Index i = 0; i < torques.size(); ++i) {
        const auto dynamics = model->getJoint("joint" + std::to_string(i + 1))->dynamics;
        REQUIRE(dynamics);
        const double velocity = xi[3 * i + 1];
        torques[i] += dynamics->damping * velocity + std::copysign(dynamics->friction, velocity);
    }
    return torques;
}

Eigen::VectorXd torques_of_model(const tools::RobotExport& exported, const Eigen::VectorXd& xi) {
    using Arm = Chain<dynamic>;
    const int n = static_cast<int>(exported.joints.size());
    Eigen::VectorXd torques =
        regressor<Arm>(chain_of<Arm>(exported.robot), {{n}, {n}, {n}}, xi) * all_parameters(exported.robot);
    for (int i = 0; i < n; ++i) {
        const tools::JointDynamics& dynamics = exported.joints[static_cast<std::size_t>(i)];
        torques[i] += dynamics.damping * xi[3 * i + 1] + std::copysign(dynamics.friction, xi[3 * i + 1]);
    }
    return torques;
}

} // namespace

TEST_CASE("an exported URDF has the torques of the extended model in any state according to KDL") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 200; ++trial) {
        const int n = 1 + trial % 7;
        const tools::RobotExport exported = random_export(engine, n);
        const Eigen::VectorXd xi = random_motion(engine, n);
        const Eigen::VectorXd expected = torques_of_model(exported, xi);
        const Eigen::VectorXd found =
            torques_of_file(tools::urdf_text(exported), xi, exported.robot.gravity.norm());
        CAPTURE(trial, n);
        CHECK((found - expected).norm() < 1e-9 * (1 + expected.norm()));
    }
}
