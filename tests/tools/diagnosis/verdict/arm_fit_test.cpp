// SPDX-License-Identifier: Apache-2.0
// Least squares of all joints at once, on an arm whose links differ from the robot's file.
#include "tools/diagnosis/verdict/arm_fit.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <cmath>
#include <random>

namespace arm_fit_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// True rotor inertia, viscous and dry friction and offset of every joint.
const Eigen::Vector4d true_terms(0.3, 5, 3, 0.4);

/// Torques of an arm with friction. Each link's mass and centre of mass differ from the robot's file as
/// `fit_arm` expects, times `size`. Independent noise of 0.3 N·m every 0.1 s.
MatrixXd measured_torques(const DiagnosisSignals& signals, double size, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    VectorXd links = VectorXd::Zero(signals.regressor.cols());
    const VectorXd nominal = nominal_parameters(signals.robot, signals.kind);
    for (Index first = 0; first < links.size(); first += 10) {
        links[first] = size * 0.1 * nominal[first] * normal(engine);
        for (Index axis = 1; axis <= 3; ++axis) {
            links[first + axis] = size * 0.03 * nominal[first] * normal(engine);
        }
    }
    const VectorXd stacked = signals.regressor * links;
    MatrixXd torques = signals.nominal;
    for (Index joint = 0; joint < torques.cols(); ++joint) {
        torques.col(joint) += stacked(Eigen::seqN(joint, signals.rows(), torques.cols())) +
                              true_terms[0] * signals.measured.motion.acceleration.col(joint) +
                              true_terms[1] * signals.measured.motion.velocity.col(joint) +
                              true_terms[2] * signals.direction(joint);
        torques.col(joint).array() += true_terms[3];
        double noise = 0;
        for (Index row = 0; row < torques.rows(); ++row) {
            noise = row % 10 == 0 ? 0.3 * normal(engine) : noise;
            torques(row, joint) += noise;
        }
    }
    return torques;
}

std::vector<MovingFit> plain_fits(const DiagnosisSignals& signals, const MatrixXd& torques) {
    std::vector<MovingFit> fits;
    for (Index joint = 0; joint < torques.cols(); ++joint) {
        fits.push_back(fit_moving_rows(signals, torques.col(joint), signals.nominal.col(joint), joint, true));
    }
    return fits;
}

/// Sum of the squared relative errors of viscous and dry friction.
double friction_error(const std::vector<MovingFit>& fits) {
    double sum = 0;
    for (const MovingFit& fit : fits) {
        sum += (fit.values.segment<2>(2).cwiseQuotient(true_terms.segment<2>(1)).array() - 1).square().sum();
    }
    return sum;
}

TEST_CASE("fit_arm finds the friction of an arm with wrong links within its deviations, more accurately than "
          "joint by joint") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    constexpr int arms = 4;
    double alone = 0;
    double together = 0;
    double squares = 0;
    for (int arm = 0; arm < arms; ++arm) {
        const MatrixXd torques = measured_torques(signals, 1, engine);
        const std::vector<MovingFit> plain = plain_fits(signals, torques);
        const ArmFit fit = fit_arm(signals, torques, plain, true);
        alone += friction_error(plain);
        together += friction_error(fit.joints);
        for (const MovingFit& joint : fit.joints) {
            CHECK_FALSE(joint.another_gain);
            const VectorXd deviations = joint.covariance.diagonal().tail<4>().cwiseSqrt();
            const VectorXd off = (joint.values.tail<4>() - true_terms).cwiseQuotient(deviations);
            CHECK(off.cwiseAbs().maxCoeff() < 5);
            squares += off.squaredNorm();
        }
        CHECK(std::sqrt(fit.rest.array().square().mean()) == Approx(0.3).epsilon(0.1));
    }
    CHECK(together < 0.5 * alone);
    const double per_value = squares / (arms * 6 * 4.0); // 1 if the deviations are right
    CHECK(per_value > 0.2);
    CHECK(per_value < 2);
}

TEST_CASE("a wrong torque constant is distinguished from wrong links") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    MatrixXd torques = measured_torques(signals, 0.3, engine);
    torques.col(1) *= 1.6; // joint 2 is loaded by gravity
    const ArmFit fit = fit_arm(signals, torques, plain_fits(signals, torques), true);
    for (std::size_t joint = 0; joint < fit.joints.size(); ++joint) {
        CAPTURE(joint);
        CHECK(fit.joints[joint].another_gain == (joint == 1));
    }
    CHECK(fit.joints[1].values[0] == Approx(1.6).epsilon(0.1));
}

TEST_CASE("a joint that hardly moves does not affect the other joints") {
    DFDYN_SEEDED_ENGINE(engine);
    DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    signals.measured.motion.position.col(5).setConstant(0.1);
    MatrixXd torques = measured_torques(signals, 0.3, engine);
    const std::vector<MovingFit> plain = plain_fits(signals, torques);
    const VectorXd before = fit_arm(signals, torques, plain, true).joints[4].values;
    torques.col(5).array() += 20;
    CHECK((fit_arm(signals, torques, plain, true).joints[4].values - before).norm() < 1e-9);
}

} // namespace arm_fit_test
