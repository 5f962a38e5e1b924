// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/response_bandwidth.hpp"

#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/signals/spectral_rows.hpp"

#include <numbers>
#include <random>

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double any_hz = 2 * SpectralRows::highest_hz;

/// A swinging arm whose joint 2 also vibrates with `amplitude` (rad) at 10 Hz.
MeasuredMotion shaking(Index joints, double amplitude) {
    MeasuredMotion measured = swing(joints);
    const double omega = 2 * std::numbers::pi * 10;
    const Eigen::ArrayXd angle = omega * measured.time_s.array();
    measured.motion.position.col(1).array() += amplitude * angle.sin();
    measured.motion.velocity.col(1).array() += omega * amplitude * angle.cos();
    measured.motion.acceleration.col(1).array() -= omega * omega * amplitude * angle.sin();
    return measured;
}

/// Response bandwidths (Hz) when the encoders show `shown` and the torques, with noise, are those of
/// `motion`.
VectorXd bandwidth_of(const MeasuredMotion& shown, const RobotMotion& motion, std::mt19937_64& engine) {
    const Robot robot = ur5();
    MeasuredMotion measured = shown;
    measured.outputs = 0.4 * rigid_outputs(robot, OutputKind::joint_torque, motion);
    std::normal_distribution<double> normal;
    for (double& value : measured.outputs.reshaped()) {
        value += 0.05 * normal(engine);
    }
    return diagnosis_signals(robot, OutputKind::joint_torque, measured).measured.response_bandwidth_hz;
}

} // namespace

TEST_CASE("the response bandwidth is unlimited if scaled outputs contain the whole motion") {
    DFDYN_SEEDED_ENGINE(engine);
    const MeasuredMotion quiet = swing(6);
    CHECK(bandwidth_of(quiet, quiet.motion, engine).minCoeff() == any_hz);
    const MeasuredMotion shaken = shaking(6, 0.003);
    CHECK(bandwidth_of(shaken, shaken.motion, engine).minCoeff() == any_hz);
}

TEST_CASE("a delay of 30 ms does not reduce the response bandwidth") {
    DFDYN_SEEDED_ENGINE(engine);
    const MeasuredMotion shaken = shaking(6, 0.003);
    RobotMotion earlier = shaken.motion;
    for (auto part : {&RobotMotion::position, &RobotMotion::velocity, &RobotMotion::acceleration}) {
        (earlier.*part).bottomRows(1997) = (shaken.motion.*part).topRows(1997);
    }
    CHECK(bandwidth_of(shaken, earlier, engine).minCoeff() == any_hz);
}

TEST_CASE("the response bandwidth ends below a vibration that is in the positions but not in the torques") {
    DFDYN_SEEDED_ENGINE(engine);
    const MeasuredMotion quiet = swing(6);
    const VectorXd hz = bandwidth_of(shaking(6, 0.003), quiet.motion, engine);
    CHECK(hz[1] < 9);
    CHECK(hz[1] > 0.5);
}
