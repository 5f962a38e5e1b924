// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/findings.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"

#include <cmath>
#include <random>

namespace findings_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One cause on the first joint, of one coefficient, that acts as either of two series; the first is chosen.
Explanation of_two_shapes(const VectorXd& first, const VectorXd& second, const VectorXd& unexplained) {
    Candidate cause;
    cause.effect = "presliding_hysteresis";
    cause.where = "joint1";
    const auto anything = [](const VectorXd&) { return true; };
    cause.columns = {{{{0, first}}}, {{{0, second}}}};
    cause.shapes = {{{0}, anything, 1}, {{1}, anything, 2}};
    cause.parameters = [](const VectorXd& coefficients, const EffectShape&) {
        return std::vector<EffectParameter>{{"level", "N·m", coefficients[0]}};
    };
    MatrixXd columns(first.size(), 2);
    columns << first, second;
    Explanation explanation;
    explanation.candidates = {cause};
    explanation.problem.sums = {columns.transpose() * columns, columns.transpose() * unexplained,
                                unexplained.squaredNorm()};
    explanation.problem.candidates.push_back({{{{0}, anything}, {{1}, anything}}});
    explanation.chosen = {{0, 0}};
    explanation.fit = explanation.named = fit_effects(explanation.problem, explanation.chosen);
    return explanation;
}

TEST_CASE("a parameter is as uncertain as the shape that it belongs to") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> normal;
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const VectorXd series = VectorXd::NullaryExpr(signals.rows(), [&] { return normal(engine); });
    const VectorXd other = VectorXd::NullaryExpr(signals.rows(), [&] { return normal(engine); });
    const VectorXd unexplained =
        2 * series + VectorXd::NullaryExpr(signals.rows(), [&] { return normal(engine); });
    MatrixXd measured = signals.nominal;
    measured.col(0) += unexplained;
    const auto reach = [&](const VectorXd& second) {
        const auto findings = findings_of(signals, of_two_shapes(series, second, unexplained), measured,
                                          std::vector<std::string>(6, "tau"));
        REQUIRE(findings.size() == 1);
        const FoundParameter& level = findings.front().parameters.front();
        CHECK(level.high - level.value == Approx(level.value - level.low));
        return level.high - level.value;
    };
    const double level = series.dot(unexplained) / series.squaredNorm();
    const double variance = 1 / series.squaredNorm();
    const auto expected = [&](double all) { return 1.96 * std::hypot(1.7 * std::sqrt(all), 0.04 * level); };
    // another shape that is out of the question tells nothing
    CHECK(reach(other) == Approx(expected(variance)));
    // one as likely, of twice the coefficient: the variance within each, and that between them
    CHECK(reach(series / 2) == Approx(expected((variance + 4 * variance + level * level) / 2)));
}

} // namespace findings_test
