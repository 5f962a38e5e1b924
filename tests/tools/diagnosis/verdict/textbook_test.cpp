// SPDX-License-Identifier: Apache-2.0
// Plain least squares for each output, and where it replaces the causes found.
#include "tools/diagnosis/verdict/textbook.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/small_fitted_effects.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/verdict/extension_errors.hpp"
#include "tools/diagnosis/verdict/findings.hpp"

#include <memory>
#include <random>

namespace textbook_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST_CASE("plain least squares finds gain, inertia, friction and offset of each joint") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const RobotMotion& motion = signals.measured.motion;
    MatrixXd measured = 0.9 * signals.nominal;
    for (Index joint = 0; joint < measured.cols(); ++joint) {
        measured.col(joint) += 0.5 * motion.acceleration.col(joint) + 3 * motion.velocity.col(joint) +
                               2 * signals.direction(joint);
        measured.col(joint).array() += 0.25;
    }
    const Index fitted = signals.rows() / 2; // the other half is predicted
    const TextbookFit fit = textbook_fit(signals, measured, signals.nominal, fitted);
    CHECK((fit.prediction - measured).cwiseAbs().maxCoeff() < 1e-3);
    const VectorXd shoulder = fit.coefficients.col(1); // loaded by gravity, with reversals
    CHECK(shoulder[0] == Approx(0.9).margin(1e-3));
    CHECK(shoulder[1] == Approx(0.5).margin(5e-3));
    CHECK(shoulder[2] == Approx(3).margin(5e-3));
    CHECK(shoulder[3] == Approx(2).margin(5e-3));
}

TEST_CASE("plain least squares of a slide has the rigid body's factor 1") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const VectorXd acceleration = signals.measured.motion.acceleration.col(0);
    MatrixXd rigid = signals.nominal;
    rigid.col(0) = 3 * acceleration; // the force of a mass, as that of a rotor
    MatrixXd measured = rigid;
    measured.col(0) += 0.5 * acceleration + 2 * signals.direction(0);
    rigid.col(5).setZero(); // a joint that carries nothing
    measured.col(5) = 2 * signals.direction(5);
    const TextbookFit fit = textbook_fit(signals, measured, rigid, signals.rows());
    CHECK(fit.coefficients(0, 0) == 1);
    CHECK(fit.coefficients(1, 0) == Approx(0.5).margin(1e-6));
    CHECK(fit.coefficients(3, 0) == Approx(2).margin(1e-6));
    CHECK(fit.coefficients(0, 5) == 1);
    CHECK(fit.coefficients(3, 5) == Approx(2).margin(1e-6));
    CHECK((fit.prediction - measured).cwiseAbs().maxCoeff() < 1e-3);
}

TEST_CASE("plain least squares replaces causes with a larger error, and the diagnosis names the output") {
    DFDYN_SEEDED_ENGINE(engine);
    auto signals = std::make_shared<DiagnosisSignals>(signals_of(ur5(), OutputKind::joint_torque));
    DiagnosisWork work;
    work.signals = signals;
    work.torque_gains = VectorXd::Ones(6);
    work.measured = signals->nominal;
    work.measured.col(0) += 5 * signals->measured.motion.velocity.col(0);
    work.measured.col(1) += random_series(*signals, engine);
    work.diagnosis.output_names = {"tau1", "tau2", "tau3", "tau4", "tau5", "tau6"};
    const VectorXd noise = random_series(*signals, engine);
    const FittedEffects fitted_effects =
        fitted_effects_of({of_one_column("coulomb_friction", "joint1", noise)}, 1, noise);

    measure_from(work, signals->rows() / 2, fitted_effects);

    const Diagnosis& diagnosis = work.diagnosis;
    CHECK(diagnosis.by_least_squares[0]);
    CHECK(diagnosis.extended.rms[0] == diagnosis.least_squares.rms[0]);
    CHECK(diagnosis.extended.rms[0] < 0.1 * diagnosis.nominal.rms[0]);
    CHECK_FALSE(diagnosis.by_least_squares[1]); // without effects
    REQUIRE(diagnosis.suspicions.size() == 1);
    CHECK_THAT(diagnosis.suspicions.front().text, Catch::Matchers::ContainsSubstring("at tau1 the causes"));
}

TEST_CASE(
    "no cause is likely if the error exceeds the output's standard deviation or if it reduces no error") {
    Diagnosis diagnosis;
    diagnosis.extended.nrmse = Eigen::Vector2d(0.3, 1.2);
    Finding right;
    right.effect = "viscous_friction";
    right.confidence = 0.95;
    right.rms_before = 2;
    right.rms_after = 1;
    Finding above = right;
    above.output = 1;
    Finding idle = right;
    idle.rms_before = 15.2;
    idle.rms_after = 15.1;
    Finding push = idle;
    push.effect = "external_contact";
    diagnosis.findings = {right, above, idle, push};
    doubt_useless_findings(diagnosis);
    CHECK(diagnosis.findings[0].confidence == 0.95);
    CHECK(diagnosis.findings[1].confidence < 0.5);
    CHECK(diagnosis.findings[2].confidence < 0.5);
    CHECK(diagnosis.findings[3].confidence == 0.95); // an event is short
}

} // namespace textbook_test
