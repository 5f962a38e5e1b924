// SPDX-License-Identifier: Apache-2.0
// Compares robots read by read_robot with those that kdl_parser and the dynamics of Orocos make of the same
// files.
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/urdf/read_robot.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/truth/regressor.hpp"

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl_parser/kdl_parser.hpp>

#include <string>

namespace {

using dfdyn::tests::regressor;
namespace tools = dfdyn::tools;

struct Case {
    std::string file, base, tip;
    Eigen::Vector3d gravity; ///< in the base's frame
};

const std::string folder = DFDYN_TEST_DATA_DIR "/robots/";
const Case cases[] = {
    {folder + "ur5/ur5_robot.urdf", "base_link", "ee_link", {0, 0, -9.81}},
    {folder + "ur5/ur5_robot.urdf", "world", "tool0", {0, 0, -9.81}},
    {folder + "icub_right_arm/icub_right_arm.urdf", "chest", "r_hand", {0, -9.81, 0}},
    {folder + "icub_right_arm/icub_right_arm.urdf", "root_link", "r_hand", {0, 0, -9.81}},
};

tools::Robot read(const Case& robot) {
    tools::ReadRobotOptions options;
    options.base = robot.base;
    options.tip = robot.tip;
    return tools::read_robot(robot.file, options);
}

KDL::Chain kdl_chain(const Case& robot) {
    KDL::Tree tree;
    REQUIRE(kdl_parser::treeFromFile(robot.file, tree));
    KDL::Chain chain;
    REQUIRE(tree.getChain(robot.base, robot.tip, chain));
    return chain;
}

KDL::JntArray column(const Eigen::VectorXd& xi, int element) {
    KDL::JntArray result(static_cast<unsigned>(xi.size() / 3));
    for (unsigned i = 0; i < result.rows(); ++i) {
        result(i) = xi[3 * static_cast<Eigen::Index>(i) + element];
    }
    return result;
}

Eigen::VectorXd random_state(std::size_t joints, std::mt19937_64& engine) {
    std::uniform_real_distribution<double> uniform(-3, 3);
    return Eigen::VectorXd::NullaryExpr(static_cast<Eigen::Index>(3 * joints),
                                        [&] { return uniform(engine); });
}

Eigen::Isometry3d tip_at(const tools::Robot& robot, const Eigen::VectorXd& xi) {
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        frame = frame * robot.joints[i].placement *
                Eigen::AngleAxisd(xi[static_cast<Eigen::Index>(3 * i)], robot.joints[i].axis);
    }
    return frame * robot.tip_placement;
}

} // namespace

TEST_CASE("forward kinematics of a robot read from URDF equal KDL's") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const Case& each : cases) {
        CAPTURE(each.file, each.base, each.tip);
        const tools::Robot robot = read(each);
        const KDL::Chain chain = kdl_chain(each);
        REQUIRE(chain.getNrOfJoints() == robot.joints.size());
        KDL::ChainFkSolverPos_recursive solver(chain);
        for (int i = 0; i < 20; ++i) {
            const Eigen::VectorXd xi = random_state(robot.joints.size(), engine);
            KDL::Frame expected;
            REQUIRE(solver.JntToCart(column(xi, 0), expected) >= 0);
            const Eigen::Isometry3d tip = tip_at(robot, xi);
            for (int row = 0; row < 3; ++row) {
                CHECK(tip.translation()[row] == Approx(expected.p[row]).margin(1e-12));
                for (int k = 0; k < 3; ++k) {
                    CHECK(tip.linear()(row, k) == Approx(expected.M(row, k)).margin(1e-12));
                }
            }
        }
    }
}

TEST_CASE("regressor times nominal parameters of a robot read from URDF equal KDL's inverse dynamics") {
    DFDYN_SEEDED_ENGINE(engine);
    using Arm = dfdyn::Chain<dfdyn::dynamic>;
    for (const Case& each : cases) {
        CAPTURE(each.file, each.base, each.tip);
        const tools::Robot robot = read(each);
        CHECK((robot.gravity - each.gravity).norm() < 1e-12);
        const auto constants = tools::firmware_chain<Arm, double>(robot);
        const Eigen::VectorXd nominal = tools::nominal_parameters(robot, tools::OutputKind::joint_torque);
        const KDL::Chain chain = kdl_chain(each);
        KDL::ChainIdSolver_RNE solver(chain, {each.gravity.x(), each.gravity.y(), each.gravity.z()});
        for (int i = 0; i < 20; ++i) {
            const Eigen::VectorXd xi = random_state(robot.joints.size(), engine);
            KDL::JntArray expected(chain.getNrOfJoints());
            const KDL::Wrenches none(chain.getNrOfSegments());
            REQUIRE(solver.CartToJnt(column(xi, 0), column(xi, 1), column(xi, 2), none, expected) == 0);
            const Eigen::VectorXd torques =
                regressor<Arm>(constants, tools::firmware_sizes<Arm>(robot), xi) * nominal;
            double difference = 0;
            double size = 0;
            for (unsigned k = 0; k < expected.rows(); ++k) {
                difference = std::hypot(difference, torques[static_cast<Eigen::Index>(k)] - expected(k));
                size = std::hypot(size, expected(k));
            }
            CHECK(difference < 1e-9 * size);
        }
    }
}
