// SPDX-License-Identifier: Apache-2.0
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/signals/rigid_model.hpp"
#include "tools/diagnosis/verdict/findings.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>

namespace ft_rotation_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;

/// Returns the wrench that a sensor measures that is turned by roll, pitch and yaw.
MatrixXd turned_by(const MatrixXd& wrench, const Eigen::Vector3d& angles) {
    const Eigen::Matrix3d matrix = (Eigen::AngleAxisd(angles[2], Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(angles[1], Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(angles[0], Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
    MatrixXd result(wrench.rows(), 6);
    result << wrench.leftCols(3) * matrix.transpose(), wrench.rightCols(3) * matrix.transpose();
    return result;
}

TEST_CASE("the columns of a turned F/T sensor are exact at the angles of the fitted model") {
    const DiagnosisSignals signals = signals_of(icub_right_arm(), OutputKind::wrench);
    FittedModel model = rigid_model(signals);
    model.sensor_angles = {0.1, -0.3, 0.4};
    const std::vector<Candidate> candidates = fitted_candidates(signals, model);
    const Candidate& rotation = find(candidates, "ft_rotation", "ft_sensor");
    MatrixXd sum = signals.nominal;
    for (Index axis = 0; axis < 3; ++axis) {
        sum += model.sensor_angles[axis] * contribution(signals, rotation, static_cast<std::size_t>(axis));
    }
    const MatrixXd expected = turned_by(signals.nominal, model.sensor_angles);
    CHECK((sum - expected).norm() < 1e-9 * expected.norm());
}

TEST_CASE("an F/T sensor that is turned by half a radian has no error of its gains") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr double yaw = 0.5;
    constexpr double noise_share = 0.02; // of an output's standard deviation
    const Robot robot = icub_right_arm();
    MeasuredMotion motion = swing(static_cast<Index>(robot.joints.size()));
    motion.outputs = turned_by(rigid_outputs(robot, OutputKind::wrench, motion.motion), {0, 0, yaw});
    std::normal_distribution<double> normal;
    for (Index output = 0; output < 6; ++output) {
        const Eigen::ArrayXd series = motion.outputs.col(output).array();
        const double deviation = std::sqrt((series - series.mean()).square().mean());
        for (double& value : motion.outputs.col(output)) {
            value += noise_share * deviation * normal(engine);
        }
    }
    const DiagnosisSignals signals = diagnosis_signals(robot, OutputKind::wrench, motion);
    const FittedEffects fitted = find_effects(signals, signals.measured.outputs, {});
    MatrixXd rest = signals.measured.outputs - signals.nominal - fitted.total_contribution(signals);
    const std::vector<Finding> findings =
        findings_of(signals, fitted, {}, rest, output_names(OutputKind::wrench, robot.joints.size()));
    const auto rotation = std::ranges::find(findings, "ft_rotation", &Finding::effect);
    REQUIRE(rotation != findings.end());
    const auto found = std::ranges::find(rotation->parameters, "yaw", &FoundParameter::name);
    REQUIRE(found != rotation->parameters.end());
    CHECK(found->value == Approx(yaw).epsilon(0.02));
    CHECK(std::ranges::none_of(
        findings, [](const Finding& one) { return one.effect == "ft_gain" && one.confidence >= 0.5; }));
}

} // namespace ft_rotation_test
