// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/findings.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/small_fitted_effects.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/base/numerics/root_mean_square.hpp"
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/verdict/error_reduction.hpp"
#include "tools/diagnosis/verdict/found_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace findings_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Findings for a recording whose first torque is the rigid body's plus `unexplained`.
std::vector<Finding> found(const DiagnosisSignals& signals, const FittedEffects& fitted_effects,
                           const VectorXd& unexplained) {
    MatrixXd rest = -fitted_effects.total_contribution(signals);
    rest.col(0) += unexplained;
    return findings_of(signals, fitted_effects, {}, rest, std::vector<std::string>(6, "tau"));
}

/// One cause on the first joint with one coefficient and two possible shapes, the first of them chosen.
FittedEffects of_two_shapes(const VectorXd& first, const VectorXd& second, const VectorXd& unexplained) {
    Candidate cause = of_one_column("presliding_hysteresis", "joint1", first);
    cause.columns.push_back(on_output(0, second));
    cause.shapes = {{{0}, is_anything, 1}, {{1}, is_anything, 2}};
    return fitted_effects_of({cause}, 1, unexplained);
}

TEST_CASE("the evidence of a cause has the output's unit and states whether the error falls or rises") {
    Robot robot = ur5();
    robot.joints[1].prismatic = true;
    const DiagnosisSignals signals = signals_of(robot, OutputKind::joint_torque);
    const MatrixXd rest = MatrixXd::Ones(signals.rows(), 6);
    const std::vector<std::string> names = output_names(OutputKind::joint_torque, 6);
    const ErrorReduction reduction(signals, rest, names);
    const auto evidence = [&](Index output, double contribution) {
        MatrixXd share = MatrixXd::Zero(signals.rows(), 6);
        share.col(output).setConstant(contribution);
        Finding finding;
        finding.effect = "torque_offset";
        reduction.describe(finding, share);
        CHECK(reduces_error(finding) == (contribution > 0));
        return finding.evidence;
    };
    CHECK_THAT(evidence(0, 1), Catch::Matchers::EndsWith("falls from 2 to 1 N·m"));
    CHECK_THAT(evidence(0, -0.5), Catch::Matchers::EndsWith("rises from 0.5 to 1 N·m"));
    CHECK_THAT(evidence(1, 1), Catch::Matchers::EndsWith("falls from 2 to 1 N"));
}

TEST_CASE("the interval of a parameter contains the uncertainty of its shape") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const VectorXd series = random_series(signals, engine);
    const VectorXd other = random_series(signals, engine);
    const VectorXd unexplained = 2 * series + random_series(signals, engine);
    const auto reach = [&](const VectorXd& second) {
        const auto findings = found(signals, of_two_shapes(series, second, unexplained), unexplained);
        REQUIRE(findings.size() == 1);
        const FoundParameter& level = findings.front().parameters.front();
        CHECK(level.high - level.value == Approx(level.value - level.low));
        return level.high - level.value;
    };
    const double level = series.dot(unexplained) / series.squaredNorm();
    const double variance = 1 / series.squaredNorm();
    const auto expected = [&](double all) { return 1.96 * std::hypot(1.7 * std::sqrt(all), 0.04 * level); };
    // A shape of negligible probability does not widen the interval.
    CHECK(reach(other) == Approx(expected(variance)));
    // Two equally likely shapes, one coefficient twice the other: the variance within each plus that between
    // them.
    CHECK(reach(series / 2) == Approx(expected((variance + 4 * variance + level * level) / 2)));
}

TEST_CASE("confidence drops if an unnamed column cancels the cause") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const VectorXd cause = random_series(signals, engine);
    const VectorXd beside = random_series(signals, engine);
    // Nearly collinear series: the data determine only their difference.
    const VectorXd nearly = cause + 0.05 * beside;
    const VectorXd unexplained = 2 * beside + random_series(signals, engine);
    const Candidate friction = of_one_column("coulomb_friction", "joint1", cause);
    const auto confidence = [&](const std::vector<std::string>& inputs) {
        Candidate against = of_one_column("viscous_friction", "joint1", nearly);
        against.inputs = inputs;
        const FittedEffects fitted_effects = fitted_effects_of({friction, against}, 2, unexplained);
        REQUIRE(fitted_effects.fit.score > 100);
        const auto findings = found(signals, fitted_effects, unexplained);
        const auto cause_found = std::ranges::find(findings, friction.effect, &Finding::effect);
        REQUIRE(cause_found != findings.end());
        return cause_found->confidence;
    };
    CHECK(confidence({}) > 0.9);
    CHECK(confidence({"qd1"}) < 0.2);
}

TEST_CASE("payload and last link are one cause unless their columns differ by more than a small share") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const VectorXd body = random_series(signals, engine);
    const VectorXd shape = random_series(signals, engine);
    const auto ties = [&](double share, const std::string& span) {
        const VectorXd unexplained = 10 * body + random_series(signals, engine);
        Candidate payload = of_one_column("payload", "tool", body);
        Candidate link = of_one_column("link_inertia_error", "link6", body + std::sqrt(share) * shape);
        payload.span = link.span = span;
        const auto findings = found(signals, fitted_effects_of({payload, link}, 1, unexplained), unexplained);
        REQUIRE(findings.size() == 1);
        return findings.front().indistinguishable.size();
    };
    CHECK(ties(0.01, "the last body") == 1);
    CHECK(ties(0.04, "the last body") == 0);
    CHECK(ties(0.01, "") == 0);
}

TEST_CASE("on an arm that moves in a plane an encoder's offset and its link's centre of mass are one cause") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const VectorXd turned = random_series(signals, engine);
    const VectorXd other = random_series(signals, engine);
    const auto ties = [&](double share, const std::string& link_name, std::size_t undetermined) {
        const VectorXd unexplained = 10 * turned + random_series(signals, engine);
        const Candidate offset = of_one_column("encoder_offset", "encoder2", turned);
        Candidate link = of_one_column("link_inertia_error", link_name, turned + std::sqrt(share) * other);
        link.shapes.front().undetermined = undetermined;
        const auto findings = found(signals, fitted_effects_of({offset, link}, 1, unexplained), unexplained);
        REQUIRE(findings.size() == 1);
        return findings.front().indistinguishable.size();
    };
    CHECK(ties(0.01, "link2", 1) == 1);
    CHECK(ties(0.04, "link2", 1) == 0);
    CHECK(ties(0.01, "link1", 1) == 0);
    CHECK(ties(0.01, "link2", 0) == 0);
}

TEST_CASE("an unexplained residual above 5 Hz does not change the gain of a finding below 5 Hz") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const VectorXd slow = (0.5 * 2 * std::numbers::pi * signals.measured.time_s.array()).sin();
    const VectorXd fast = (30 * 2 * std::numbers::pi * signals.measured.time_s.array()).sin();
    // The weighted fit contains only the slow part.
    FittedEffects fitted_effects =
        fitted_effects_of({of_one_column("backlash", "joint1", slow)}, 1, 2 * slow);
    fitted_effects.candidates.front().columns.front() = on_output(0, slow + fast);
    const auto findings = found(signals, fitted_effects, 2 * slow - 3 * fast);
    REQUIRE(findings.size() == 1);
    CHECK(findings.front().rms_before == Approx(2 * root_mean_square(slow)).epsilon(0.02));
    CHECK(findings.front().rms_after < 0.2 * findings.front().rms_before);
}

TEST_CASE("the gain of a cause that acts only above 5 Hz is measured there") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const VectorXd fast = (20 * 2 * std::numbers::pi * signals.measured.time_s.array()).sin();
    const VectorXd leak = 2 * signals.below(reduction_below_hz, fast);
    REQUIRE(leak.norm() > 0);
    REQUIRE(leak.norm() < 0.1 * fast.norm());
    // The residual below 5 Hz happens to cancel the small part that the cause has there.
    const auto findings =
        found(signals, fitted_effects_of({of_one_column("torque_ripple", "joint1", fast)}, 1, 2 * fast),
              2 * fast - leak);
    REQUIRE(findings.size() == 1);
    CHECK(findings.front().rms_before == Approx(2 * root_mean_square(fast)).epsilon(0.1));
}

TEST_CASE("a push at a joint at rest is reported with its force and the share that friction can hold") {
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    StationaryContact push;
    push.joint = 2;
    push.pulse = {8, 9, 0.3};
    push.change = 30;
    push.change_deviation = 0.5;
    push.held = 10;
    push.held_deviation = 2;
    push.share = 30 * pulse_series(signals, push.pulse);
    const MatrixXd rest = MatrixXd::Constant(signals.rows(), 6, 0.1);
    const std::vector<Finding> findings =
        findings_of(signals, fitted_effects_of({}, 0, VectorXd::Zero(signals.rows())), {push}, rest,
                    {"tau1", "tau2", "tau3", "tau4", "tau5", "tau6"});
    REQUIRE(findings.size() == 1);
    const Finding& finding = findings.front();
    CHECK(finding.effect == "external_contact");
    CHECK(finding.where == "joint3");
    CHECK(finding.output == 2);
    CHECK(finding.confidence == Approx(0.95));
    const FoundParameter& peak = finding.parameters[2];
    CHECK(peak.name == "peak");
    // The force of the surroundings opposes the motor's 30 N·m, half of the friction's 10 and a rounder top.
    CHECK(peak.value == Approx(-30 - 5 - 4.5));
    CHECK(peak.high == Approx(-30 + 1.96 * std::hypot(0.5, 2)));
    CHECK(peak.low == Approx(-40 - 9 - 1.96 * std::hypot(0.5, 2)));
    CHECK(finding.evidence.find("joint3 is stationary") == 0);
    CHECK(finding.evidence.find("10 ± 3.92 N·m") != std::string::npos);
    CHECK(finding.share == push.share);
}

TEST_CASE("the interval of a certain, positive size has 95 % of the positive half of its distribution") {
    const auto below = [](double limit, double mean, double deviation) {
        return 0.5 * std::erfc((mean - limit) / (deviation * std::numbers::sqrt2));
    };
    for (const double deviation : {0.1, 1.0, 3.0}) {
        const FoundParameter one = positive_parameter("viscous", "N·m·s/rad", 2, deviation);
        CAPTURE(deviation, one.low, one.high);
        const double none = below(0, 2, deviation);
        CHECK(one.low > 0);
        CHECK((below(one.low, 2, deviation) - none) / (1 - none) == Approx(0.025));
        CHECK((below(one.high, 2, deviation) - none) / (1 - none) == Approx(0.975));
    }
    // far from zero it is the usual interval
    CHECK(positive_parameter("viscous", "N·m·s/rad", 2, 0.1).low == Approx(2 - 0.196).epsilon(1e-3));
}

TEST_CASE("a cause whose only size may be none is below 0.5, and a wrong link with one certain part is not") {
    const auto confidence_of = [](const std::string& effect, std::vector<FoundParameter> parameters) {
        Diagnosis diagnosis;
        diagnosis.extended.nrmse = VectorXd::Constant(1, 0.2);
        Finding finding;
        finding.effect = effect;
        finding.parameters = std::move(parameters);
        finding.confidence = 0.9;
        finding.rms_before = 2;
        finding.rms_after = 1;
        diagnosis.findings = {finding};
        doubt_useless_findings(diagnosis);
        return diagnosis.findings.front().confidence;
    };
    CHECK(confidence_of("viscous_friction", {{"viscous", "N·m·s/rad", 2, 0.1, 3.9}}) == 0.9);
    CHECK(confidence_of("viscous_friction", {{"viscous", "N·m·s/rad", 2, -0.1, 4.1}}) < 0.5);
    CHECK(confidence_of("actuator_gain", {{"gain", "1", 1.1, 0.9, 1.3}}) < 0.5);
    CHECK(confidence_of("actuator_gain", {{"gain", "1", 1.1, 1.05, 1.15}}) == 0.9);
    CHECK(confidence_of("viscous_friction", {{"viscous", "N·m·s/rad", 2, 2, 2}}) == 0.9); // not fitted
    CHECK(confidence_of("link_inertia_error",
                        {{"delta_mass", "kg", 0.1, -1, 1.2}, {"delta_com_x", "m", 0.1, 0.05, 0.15}}) == 0.9);
}

} // namespace findings_test
