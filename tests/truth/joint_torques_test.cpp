// SPDX-License-Identifier: Apache-2.0
// Compares the regressor of joint torques with the recursive Newton-Euler algorithm of the Orocos project.
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/truth/kdl_torques.hpp"
#include "tests/truth/regressor.hpp"

namespace {

using namespace dfdyn;
using namespace dfdyn::tests;

KDL::Vector kdl_vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

KDL::Frame kdl_frame(const Eigen::Isometry3d& placement) {
    const Eigen::Matrix3d& r = placement.linear();
    return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
            kdl_vector(placement.translation())};
}

KDL::RigidBodyInertia kdl_inertia(const tools::InertialParameters& parameters) {
    const Body body = body_of(parameters);
    const Eigen::Matrix3d& i = body.central_inertia;
    return KDL::RigidBodyInertia(
        body.mass, kdl_vector(body.centre),
        KDL::RotationalInertia(i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)));
}

KDL::Chain kdl_chain(const tools::Robot& robot) {
    KDL::Chain chain;
    for (const tools::RobotJoint& joint : robot.joints) {
        // The axis is given in the frame before the joint.
        const Eigen::Vector3d axis = joint.placement.linear() * joint.axis;
        const KDL::Joint moving(kdl_vector(joint.placement.translation()), kdl_vector(axis),
                                joint.prismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis);
        chain.addSegment(KDL::Segment(moving, kdl_frame(joint.placement), kdl_inertia(joint.inertia)));
    }
    return chain;
}

Eigen::VectorXd kdl_torques(const tools::Robot& robot, const Eigen::VectorXd& xi) {
    return tests::kdl_torques(kdl_chain(robot), kdl_vector(robot.gravity), xi);
}

} // namespace

TEST_CASE("torques of any chain in any state equal those of recursive Newton-Euler") {
    DFDYN_SEEDED_ENGINE(engine);
    using Arm = Chain<dynamic>;
    for (int trial = 0; trial < 1000; ++trial) {
        const int n = 1 + trial % 8;
        const tools::Robot robot = random_robot(engine, n);
        const Eigen::VectorXd xi = random_motion(engine, n);
        const Eigen::VectorXd expected = kdl_torques(robot, xi);
        const Eigen::VectorXd torques =
            regressor<Arm>(chain_of<Arm>(robot), {{n}, {n}, {n}}, xi) * all_parameters(robot);
        CAPTURE(trial, n);
        REQUIRE((torques - expected).norm() < 1e-9 * expected.norm());
    }
}
