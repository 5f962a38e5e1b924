// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/row_weight.hpp"

#include "tests/tools/diagnosis/swinging_arm.hpp"

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;

/// The first of two joints stands from 5 s to 8 s, as far as a quantiser of 1.5 mrad lets anybody see.
MeasuredMotion stopping() {
    MeasuredMotion measured = swing(2);
    for (Index row = 500; row < 800; ++row) {
        measured.motion.position(row, 0) = measured.motion.position(500, 0) + (row % 7 < 3 ? 1.5e-3 : 0);
    }
    return measured;
}

} // namespace

TEST_CASE("what a joint's torque is while it stands does not count, what the others' are does") {
    const MatrixXd weight = joint_row_weight(stopping());
    CHECK(weight.col(0).segment(500, 300).maxCoeff() == 0);
    CHECK(weight.col(0).segment(100, 350).minCoeff() == 1);
    CHECK(weight.col(0).segment(850, 1000).minCoeff() == 1);
    CHECK(weight.col(1).segment(100, 1800).minCoeff() == 1);
}

TEST_CASE("a joint that turns round slowly does not stand, and stops of a third of a second are none") {
    MeasuredMotion measured = swing(1);
    measured.motion.position.col(0) = 0.5 * (0.8 * measured.time_s.array()).cos();
    CHECK(joint_row_weight(measured).middleRows(100, 1800).minCoeff() == 1);
    measured = swing(1);
    measured.motion.position.col(0).segment(700, 33).setConstant(measured.motion.position(700, 0));
    CHECK(joint_row_weight(measured).middleRows(100, 1800).minCoeff() == 1);
}

TEST_CASE("a joint that never moves still tells what the arm weighs") {
    MeasuredMotion measured = swing(2);
    measured.motion.position.col(0).setConstant(0.3);
    CHECK(joint_row_weight(measured).middleRows(100, 1800).minCoeff() == 1);
}

TEST_CASE("the ends of a stretch count little, for they are smoothed by one side only") {
    MeasuredMotion measured = swing(1);
    measured.smoothing_hz.setConstant(5);
    measured.stretches = {{0, 700}, {700, 1300}};
    const Eigen::VectorXd weight = end_row_weight(measured);
    for (const Index end : {Index{0}, Index{699}, Index{700}, Index{1999}}) {
        CHECK(weight[end] < 0.01);
    }
    CHECK(weight.segment(20, 660).minCoeff() == 1);
    CHECK(weight.segment(720, 1260).minCoeff() == 1);
}
