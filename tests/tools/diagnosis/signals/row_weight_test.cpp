// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/row_weight.hpp"

#include "tests/tools/diagnosis/swinging_arm.hpp"

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;

/// The weights depend on the robot's kinds of joints only.
Robot with_joints(Index count, bool prismatic = false) {
    Robot robot;
    robot.joints.resize(static_cast<std::size_t>(count));
    for (RobotJoint& joint : robot.joints) {
        joint.prismatic = prismatic;
    }
    return robot;
}

/// Row weights for a joint whose torques equal its positions, plus a slow disturbance of amplitude
/// `straying`.
MatrixXd weight_of(MeasuredMotion measured, double straying, bool prismatic = false) {
    const MatrixXd torques = measured.motion.position;
    const Eigen::ArrayXd slowly = (3 * measured.time_s.array()).sin();
    measured.outputs = 0.3 * (torques.colwise() + straying * slowly.matrix());
    return joint_row_weight(with_joints(torques.cols(), prismatic), measured, torques);
}

/// The first of two joints rests from 5 s to 8 s, apart from a quantiser's 1.5 mrad. The second moves
/// throughout.
MeasuredMotion stopping() {
    MeasuredMotion measured = swing(2);
    measured.motion.position.col(1) = measured.motion.position.col(0);
    for (Index row = 500; row < 800; ++row) {
        measured.motion.position(row, 0) = measured.motion.position(500, 0) + (row % 7 < 3 ? 1.5e-3 : 0);
    }
    return measured;
}

} // namespace

TEST_CASE("an unexplained torque of a joint at rest has no weight and those of other joints keep theirs") {
    const MatrixXd weight = weight_of(stopping(), 0.2);
    CHECK(weight.col(0).segment(500, 300).maxCoeff() == 0);
    CHECK(weight.col(0).segment(200, 260).minCoeff() == 1);
    CHECK(weight.col(0).segment(840, 900).minCoeff() == 1);
    CHECK(weight.col(1).segment(200, 1600).minCoeff() == 1);
}

TEST_CASE("an output that agrees with the torques during standstill keeps its weight") {
    CHECK(weight_of(stopping(), 0.01).middleRows(200, 1600).minCoeff() == 1);
}

TEST_CASE("a joint that sticks for a third of a second at a reversal is at rest") {
    MeasuredMotion measured = swing(1);
    constexpr Index first = 700;
    constexpr Index count = 33;
    measured.motion.position.col(0).segment(first, count).setConstant(measured.motion.position(first, 0));
    measured.outputs = 0.3 * measured.motion.position;
    measured.outputs.col(0).segment(first, count) += 2 * Eigen::VectorXd::LinSpaced(count, -1, 1);
    const MatrixXd weight = joint_row_weight(with_joints(1), measured, measured.motion.position);
    CHECK(weight.middleRows(first, count).maxCoeff() == 0);
    CHECK(weight.middleRows(200, first - 200 - 40).minCoeff() == 1);
    CHECK(weight.middleRows(first + count + 40, 1000).minCoeff() == 1);
}

TEST_CASE("neither a slow reversal nor a stop of a fifth of a second is a standstill") {
    MeasuredMotion measured = swing(1);
    measured.motion.position.col(0) = 0.5 * (0.8 * measured.time_s.array()).cos();
    CHECK(weight_of(measured, 0.2).middleRows(200, 1600).minCoeff() == 1);
    measured = swing(1);
    measured.motion.position.col(0).segment(700, 20).setConstant(measured.motion.position(700, 0));
    CHECK(weight_of(measured, 0.2).middleRows(200, 1600).minCoeff() == 1);
}

TEST_CASE("the rows of a joint that never moves keep their weight") {
    MeasuredMotion measured = swing(1);
    measured.motion.position.setConstant(0.3);
    CHECK(weight_of(measured, 0.2).middleRows(200, 1600).minCoeff() == 1);
}

TEST_CASE("a slide at 8 mm/s is not at rest, and one at 0.8 mm/s is") {
    for (const double speed : {8e-3, 8e-4}) {
        CAPTURE(speed);
        MeasuredMotion measured = swing(1);
        const double start = measured.motion.position(800, 0);
        for (Index row = 800; row < 1100; ++row) {
            measured.motion.position(row, 0) = start + speed * (measured.time_s[row] - 8);
        }
        const MatrixXd weight = weight_of(measured, 0.2, true).middleRows(800, 300);
        CHECK(weight.minCoeff() == (speed > 1e-3 ? 1 : 0));
        CHECK(weight.maxCoeff() == weight.minCoeff());
    }
}

TEST_CASE("an output that is constant at rest keeps its weight at a joint that moves no mass") {
    MeasuredMotion measured = stopping();
    measured.outputs = 0.3 * measured.motion.position;
    measured.outputs.col(0).segment(500, 300).setConstant(measured.outputs(500, 0));
    const MatrixXd weight = joint_row_weight(with_joints(2), measured, MatrixXd::Zero(2000, 2));
    CHECK(weight.middleRows(200, 1600).minCoeff() == 1);
}

TEST_CASE("the weight tapers at the ends of each segment and is one in between") {
    MeasuredMotion measured = swing(1);
    measured.stretches = {{0, 480}, {480, 1520}};
    const Eigen::VectorXd weight = end_row_weight(measured);
    for (const Index end : {Index{0}, Index{479}, Index{480}, Index{1999}}) {
        CHECK(weight[end] < 0.01);
    }
    CHECK(weight.segment(80, 320).minCoeff() == 1);
    CHECK(weight.segment(680, 1120).minCoeff() == 1);
    CHECK(weight[40] == Approx(0.5).margin(0.02));
    CHECK(weight[580] == Approx(0.5).margin(0.02));
}
