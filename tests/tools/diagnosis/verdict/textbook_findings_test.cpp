// SPDX-License-Identifier: Apache-2.0
// Findings of plain least squares at a joint where its error is smaller than with the causes found.
#include "tools/diagnosis/verdict/textbook_findings.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/small_fitted_effects.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace textbook_findings_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double dry = 2;     // N·m
constexpr double viscous = 5; // N·m·s/rad

/// Noise that is correlated over half a second.
VectorXd slow_noise(Index rows, double deviation, std::mt19937_64& engine) {
    constexpr double kept = 0.98;
    std::normal_distribution<double> normal(0, deviation * std::sqrt(1 - kept * kept));
    VectorXd noise(rows);
    double value = 0;
    for (double& one : noise) {
        one = value = kept * value + normal(engine);
    }
    return noise;
}

/// A UR5 with friction at joint 1 that the search missed, and plain least squares there.
DiagnosisWork work_with_friction(std::mt19937_64& engine, double noise) {
    auto signals = std::make_shared<DiagnosisSignals>(signals_of(ur5(), OutputKind::joint_torque));
    DiagnosisWork work;
    work.signals = signals;
    work.torque_gains = VectorXd::Ones(6);
    work.measured = signals->nominal;
    work.measured.col(0) += viscous * signals->measured.motion.velocity.col(0) + dry * signals->direction(0) +
                            slow_noise(signals->rows(), noise, engine);
    work.rest = work.measured - signals->nominal;
    work.fitted_effects = fitted_effects_of({}, 0, random_series(*signals, engine));
    work.diagnosis.output_names = {"tau1", "tau2", "tau3", "tau4", "tau5", "tau6"};
    work.diagnosis.by_least_squares = {true, false, false, false, false, false};
    return work;
}

Finding finding(const std::string& effect, const std::string& where, double confidence) {
    Finding one;
    one.effect = effect;
    one.where = where;
    one.confidence = confidence;
    one.parameters = {{"start", "s", 1, 1, 1}, {"end", "s", 2, 2, 2}};
    one.rms_before = 2;
    one.rms_after = 1;
    return one;
}

const Finding* found(const DiagnosisWork& work, const std::string& effect, const std::string& where) {
    const auto& findings = work.diagnosis.findings;
    const auto at = std::ranges::find_if(
        findings, [&](const Finding& one) { return one.effect == effect && one.where == where; });
    return at == findings.end() ? nullptr : &*at;
}

TEST_CASE("plain least squares with the smaller error names its friction and makes other causes at the joint "
          "unlikely") {
    DFDYN_SEEDED_ENGINE(engine);
    DiagnosisWork work = work_with_friction(engine, 0.3);
    work.diagnosis.findings = {finding("presliding_hysteresis", "joint1", 0.9),
                               finding("coulomb_friction", "joint1", 0.9), finding("delay", "actuator1", 0.8),
                               finding("external_contact", "joint1", 0.9),
                               finding("coulomb_friction", "joint2", 0.9)};

    name_by_least_squares(work);

    for (const auto& [effect, truth] : {std::pair{"coulomb_friction", dry}, {"viscous_friction", viscous}}) {
        CAPTURE(effect);
        const Finding* const one = found(work, effect, "joint1");
        REQUIRE(one != nullptr);
        CHECK(one->confidence >= 0.5);
        CHECK(one->parameters.front().low < truth);
        CHECK(one->parameters.front().high > truth);
        CHECK(one->rms_after < one->rms_before);
    }
    CHECK(found(work, "rotor_inertia", "joint1") == nullptr); // there is none
    CHECK(found(work, "presliding_hysteresis", "joint1")->confidence < 0.5);
    CHECK(found(work, "delay", "actuator1")->confidence < 0.5);
    CHECK(found(work, "external_contact", "joint1")->confidence == 0.9); // an event
    CHECK(found(work, "coulomb_friction", "joint2")->confidence == 0.9);
    CHECK((work.measured - work.extended).col(0).norm() < 0.1 * work.measured.col(0).norm());
    CHECK((work.extended.col(1) - work.signals->nominal.col(1)).norm() == 0);
}

TEST_CASE("wrong centres of mass are no torque offset of plain least squares") {
    DFDYN_SEEDED_ENGINE(engine);
    DiagnosisWork work = work_with_friction(engine, 0.3);
    MeasuredMotion measured = swing(6);
    RobotMotion& motion = measured.motion;
    motion.position = (0.1 * motion.position).eval(); // the load at each joint hardly changes
    motion.velocity = (0.1 * motion.velocity).eval();
    motion.acceleration = (0.1 * motion.acceleration).eval();
    auto signals = std::make_shared<DiagnosisSignals>(
        diagnosis_signals(ur5(), OutputKind::joint_torque, std::move(measured)));
    const VectorXd nominal = nominal_parameters(signals->robot, signals->kind);
    work.signals = signals;
    work.measured = signals->nominal;
    for (Index body = 0; body < nominal.size() / 10; ++body) {
        Eigen::Matrix<double, 10, 1> error = Eigen::Matrix<double, 10, 1>::Zero();
        error.segment<3>(1).setConstant(0.02 * nominal[10 * body]); // 2 cm along each axis
        work.measured += signals->of_body(body, error);
    }
    for (Index joint = 0; joint < 6; ++joint) {
        work.measured.col(joint) += slow_noise(signals->rows(), 0.05, engine);
    }
    work.gains_known = false;
    work.diagnosis.by_least_squares = {false, true, true, false, false, false}; // joints that carry weight
    name_by_least_squares(work);
    for (const std::string joint : {"joint2", "joint3"}) {
        const Finding* const offset = found(work, "torque_offset", joint);
        CHECK((offset == nullptr || offset->confidence < 0.5));
    }
}

TEST_CASE("a joint that moves for a few seconds keeps the findings of the search") {
    DFDYN_SEEDED_ENGINE(engine);
    DiagnosisWork work = work_with_friction(engine, 0.3);
    DiagnosisSignals signals = *work.signals;
    signals.measured.weight = Eigen::MatrixXd::Zero(signals.rows(), 6);
    signals.measured.weight.topRows(200).setOnes(); // 2 s: eight blocks
    work.signals = std::make_shared<DiagnosisSignals>(std::move(signals));
    work.diagnosis.findings = {finding("coulomb_friction", "joint1", 0.9)};
    name_by_least_squares(work);
    REQUIRE(work.diagnosis.findings.size() == 1);
    CHECK(work.diagnosis.findings.front().confidence == 0.9);
}

TEST_CASE("least squares confirms a gain and lowers the confidence of a delay at the same actuator") {
    DFDYN_SEEDED_ENGINE(engine);
    DiagnosisWork work = work_with_friction(engine, 0.3);
    const DiagnosisSignals& signals = *work.signals;
    work.measured.col(1) = 1.4 * signals.nominal.col(1) + dry * signals.direction(1) +
                           slow_noise(signals.rows(), 0.3, engine); // joint 2 carries weight
    work.diagnosis.by_least_squares[1] = true;
    work.diagnosis.findings = {finding("actuator_gain", "actuator2", 0.9),
                               finding("delay", "actuator2", 0.9)};
    name_by_least_squares(work);
    CHECK(found(work, "actuator_gain", "actuator2")->confidence == 0.9);
    CHECK(found(work, "delay", "actuator2")->confidence < 0.5);
    CHECK(work.diagnosis.textbook(0, 1) == Approx(1.4).margin(0.02));
}

TEST_CASE("a rigid-body torque proportional to the acceleration gives no rotor inertia") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const VectorXd rigid =
        3 * signals.measured.motion.acceleration.col(0); // like the gravity-free torque of a prismatic joint
    const VectorXd measured = rigid + slow_noise(signals.rows(), 0.3, engine);
    for (const bool gain_known : {false, true}) {
        const MovingFit fit = fit_moving_rows(signals, measured, rigid, 0, gain_known);
        CHECK(fit.values[0] == 1);
        CHECK(std::abs(fit.values[1]) < 4 * std::sqrt(fit.covariance(1, 1)));
        CHECK_FALSE(fit.another_gain);
    }
}

TEST_CASE("the intervals of plain least squares contain the true values under slow noise") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr int runs = 100;
    int dry_held = 0;
    int viscous_held = 0;
    for (int run = 0; run < runs; ++run) {
        DiagnosisWork work = work_with_friction(engine, 1);
        name_by_least_squares(work);
        const auto holds = [&](const char* effect, double truth) {
            const Finding* const one = found(work, effect, "joint1");
            if (one == nullptr) {
                return false;
            }
            const FoundParameter& value = one->parameters.front();
            CHECK((value.high - value.low) / 2 < truth);
            return value.low < truth && truth < value.high;
        };
        dry_held += holds("coulomb_friction", dry) ? 1 : 0;
        viscous_held += holds("viscous_friction", viscous) ? 1 : 0;
    }
    CAPTURE(dry_held, viscous_held);
    CHECK(viscous_held >= 90);
    CHECK(dry_held >= 90);
}

TEST_CASE("where no effect is exactly right at half of the joints, the friction of every joint is named") {
    DFDYN_SEEDED_ENGINE(engine);
    DiagnosisWork work = work_with_friction(engine, 0.3);
    const DiagnosisSignals& signals = *work.signals;
    for (Index joint = 1; joint < 6; ++joint) {
        work.measured.col(joint) += viscous * signals.measured.motion.velocity.col(joint) +
                                    dry * signals.direction(joint) + slow_noise(signals.rows(), 0.3, engine);
    }
    work.diagnosis.by_least_squares = std::vector<bool>(6, false);
    work.diagnosis.findings = {finding("presliding_hysteresis", "joint3", 0.9),
                               finding("external_contact", "joint3", 0.9), finding("payload", "tool", 0.9)};
    DiagnosisWork exact = work;

    work.fitted_effects.inexact = {true, true, true, false, false, false};
    name_by_least_squares(work);
    for (const std::string joint : {"joint1", "joint2", "joint3", "joint4", "joint5", "joint6"}) {
        for (const auto& [effect, truth] :
             {std::pair{"coulomb_friction", dry}, {"viscous_friction", viscous}}) {
            CAPTURE(joint, effect);
            const Finding* const one = found(work, effect, joint);
            REQUIRE(one != nullptr);
            CHECK(one->confidence >= 0.5);
            CHECK(one->parameters.front().low < truth);
            CHECK(one->parameters.front().high > truth);
        }
        const Finding* const offset = found(work, "torque_offset", joint); // there is none
        CHECK((offset == nullptr || offset->confidence < 0.5));
    }
    CHECK(found(work, "presliding_hysteresis", "joint3")->confidence < 0.5);
    CHECK(found(work, "external_contact", "joint3")->confidence == 0.9); // an event
    CHECK(found(work, "payload", "tool")->confidence == 0.9);            // not of a joint
    CHECK(
        work.extended.isApprox(signals.nominal)); // the model with the smaller error was not determined here

    exact.fitted_effects.inexact = {true, true, false, false, false, false};
    name_by_least_squares(exact);
    CHECK(exact.diagnosis.findings.size() == 3);
}

} // namespace textbook_findings_test
