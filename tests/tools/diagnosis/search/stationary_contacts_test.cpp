// SPDX-License-Identifier: Apache-2.0
// Pushes at a joint at rest, hidden among the changes of its static friction.
#include "tools/diagnosis/search/stationary_contacts.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/small_fitted_effects.hpp"
#include "tests/tools/robot/arms.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double friction = 5; ///< N·m
constexpr Index stand_first = 200, stand_rows = 1500;

/// A swinging arm whose first joint rests from 2 to 17 s.
DiagnosisSignals standing_arm() {
    DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    signals.measured.weight.setOnes(signals.rows(), signals.outputs());
    signals.measured.weight.col(0).segment(stand_first, stand_rows).setZero();
    signals.measured.motion.velocity.col(0).segment(stand_first, stand_rows).setZero();
    return signals;
}

/// Friction of the first joint, known to within a few percent.
Candidate friction_cause(const DiagnosisSignals& signals, const std::string& parameter) {
    Candidate candidate = of_one_column("coulomb_friction", "joint1", signals.direction(0));
    candidate.parameters = [parameter](const VectorXd& coefficients, const EffectShape&) {
        return std::vector<EffectParameter>{{parameter, "N·m", coefficients[0]}};
    };
    return candidate;
}

FittedEffects with_friction(const DiagnosisSignals& signals, const std::string& parameter) {
    return fitted_effects_of({friction_cause(signals, parameter)}, 1, friction * signals.direction(0));
}

std::vector<StationaryContact> pushes_in(const DiagnosisSignals& signals, const FittedEffects& fitted_effects,
                                         const MatrixXd& measured) {
    return stationary_contacts(signals, fitted_effects, measured,
                               measured - signals.nominal - fitted_effects.total_contribution(signals));
}

/// Torques of a joint that rests undisturbed: it creeps, and its friction yields in both directions.
MatrixXd resting(const DiagnosisSignals& signals, std::mt19937_64& engine) {
    std::uniform_real_distribution<double> held(-friction, friction);
    std::normal_distribution<double> noise(0, 0.05);
    MatrixXd rest = MatrixXd::Zero(signals.rows(), signals.outputs());
    double level = held(engine);
    for (Index row = stand_first; row < stand_first + stand_rows; ++row) {
        if (std::bernoulli_distribution(0.01)(engine)) {
            level = held(engine);
        }
        rest(row, 0) =
            (row == stand_first ? level : 0.9 * rest(row - 1, 0) + 0.1 * level) + 0.1 * noise(engine);
    }
    return signals.nominal + rest;
}

} // namespace

TEST_CASE("a torque that friction can hold at rest is not a push") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = standing_arm();
    const MatrixXd measured = resting(signals, engine);
    const auto most_likely = [&](double times) {
        const MatrixXd louder = signals.nominal + times * (measured - signals.nominal);
        double most = 0;
        for (const StationaryContact& push : pushes_in(signals, with_friction(signals, "coulomb"), louder)) {
            most = std::max(most, push.probability());
        }
        return most;
    };
    CHECK(most_likely(1) < 0.5);
    CHECK(most_likely(5) > 0.9); // the same residual is a push if friction is five times smaller
}

TEST_CASE("the noise of a long standstill whose friction is small is not a push") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = standing_arm();
    const FittedEffects fitted_effects =
        fitted_effects_of({friction_cause(signals, "coulomb")}, 1, 0.5 * signals.direction(0));
    for (const double kept : {0.0, 0.9}) { // of the noise, from one row to the next
        int named = 0;
        for (int draw = 0; draw < 20; ++draw) {
            std::normal_distribution<double> noise(0, 5);
            MatrixXd measured = signals.nominal;
            double level = 0;
            for (Index row = stand_first; row < stand_first + stand_rows; ++row) {
                level = kept * level + noise(engine);
                measured(row, 0) += level;
            }
            named +=
                std::ranges::any_of(pushes_in(signals, fitted_effects, measured),
                                    [](const StationaryContact& push) { return push.probability() > 0.9; });
        }
        CAPTURE(kept);
        CHECK(named <= 1);
    }
}

TEST_CASE("a push larger than friction is found at a joint at rest with its time and size") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = standing_arm();
    const double start_s = std::uniform_real_distribution<double>(3, 15)(engine);
    const double change = std::bernoulli_distribution(0.5)(engine) ? 30.0 : -30.0;
    const ContactPulse pulse{start_s, start_s + 0.75, 0.2};
    MatrixXd measured = resting(signals, engine);
    measured.col(0) += change * pulse_series(signals, pulse);
    const std::vector<StationaryContact> pushes =
        pushes_in(signals, with_friction(signals, "coulomb"), measured);
    const auto found = std::ranges::max_element(pushes, {}, &StationaryContact::probability);
    REQUIRE(found != pushes.end());
    CHECK(found->joint == 0);
    CHECK(found->probability() > 0.99);
    CHECK(found->pulse.start_s == Approx(start_s).margin(0.3));
    CHECK(found->pulse.end_s == Approx(start_s + 0.75).margin(0.3));
    CHECK(found->change == Approx(change).margin(2 * friction));
    CHECK(found->held == Approx(2 * friction).epsilon(0.1));
    CHECK((found->share - change * pulse_series(signals, pulse)).norm() < 0.6 * found->share.norm());
}

TEST_CASE("a joint that moves or whose dry friction is unknown is never reported as pushed at rest") {
    DFDYN_SEEDED_ENGINE(engine);
    DiagnosisSignals signals = standing_arm();
    MatrixXd measured = resting(signals, engine);
    measured.col(0) += 30 * pulse_series(signals, {8, 8.75, 0.2});
    measured.col(1) += 30 * pulse_series(signals, {8, 8.75, 0.2});
    CHECK(pushes_in(signals, with_friction(signals, "viscous"), measured).empty());
    const auto pushes = pushes_in(signals, with_friction(signals, "coulomb"), measured);
    REQUIRE_FALSE(pushes.empty());
    CHECK(std::ranges::all_of(pushes, [](const StationaryContact& push) { return push.joint == 0; }));
    signals.measured.weight.setOnes();
    CHECK(pushes_in(signals, with_friction(signals, "coulomb"), measured).empty());
}

TEST_CASE("no push at rest is reported if the friction estimate is uncertain") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = standing_arm();
    MatrixXd measured = resting(signals, engine);
    measured.col(0) += 30 * pulse_series(signals, {8, 8.75, 0.2});
    FittedEffects fitted_effects = with_friction(signals, "coulomb");
    CHECK_FALSE(pushes_in(signals, fitted_effects, measured).empty());
    constexpr double precision = 1e-3; // as a share of all measurements
    fitted_effects.problem.sums.gram *= precision;
    fitted_effects.problem.sums.moment *= precision;
    fitted_effects.named = fit_effects(fitted_effects.problem, fitted_effects.named_effects());
    fitted_effects.values = fitted_effects.named;
    CHECK(pushes_in(signals, fitted_effects, measured).empty());
}

TEST_CASE("more than three uncertain pushes at a joint are its usual deviations, and a certain one remains") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = standing_arm();
    std::normal_distribution<double> noise(0, 0.3);
    MatrixXd at_rest = signals.nominal;
    for (Index row = stand_first; row < stand_first + stand_rows; ++row) {
        at_rest(row, 0) += noise(engine);
    }
    const auto pushes_of = [&](const std::vector<double>& changes) {
        MatrixXd measured = at_rest;
        for (std::size_t i = 0; i < changes.size(); ++i) {
            const double start_s = 3 + 2.2 * static_cast<double>(i);
            measured.col(0) += changes[i] * pulse_series(signals, {start_s, start_s + 0.75, 0.2});
        }
        return pushes_in(signals, with_friction(signals, "coulomb"), measured);
    };
    double uncertain = 2 * friction;
    while (pushes_of({uncertain}).empty() || pushes_of({uncertain})[0].probability() < 0.7) {
        uncertain += 0.02;
        REQUIRE(uncertain < 3 * friction);
    }
    CAPTURE(uncertain);
    CHECK(pushes_of({uncertain, uncertain, uncertain}).size() == 3);
    CHECK(pushes_of(std::vector<double>(5, uncertain)).empty());
    const auto remaining = pushes_of({uncertain, uncertain, 30, uncertain, uncertain, uncertain});
    REQUIRE(remaining.size() == 1);
    CHECK(remaining[0].change == Approx(30).epsilon(0.2));
}

TEST_CASE("a push as large as static friction has a probability of one half") {
    StationaryContact push;
    push.change = -10;
    push.held = 10;
    push.change_deviation = 3;
    push.held_deviation = 4;
    CHECK(push.probability() == Approx(0.5));
    push.change = -20; // two standard deviations of 5 more, from the table of the normal distribution
    CHECK(push.probability() == Approx(0.97725).epsilon(1e-4));
}

TEST_CASE("a torque at rest that a cause predicts but that was not measured is not a push") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = standing_arm();
    const VectorXd said = pulse_series(signals, {8, 8.75, 0.2});
    const FittedEffects fitted_effects =
        fitted_effects_of({friction_cause(signals, "coulomb"), of_one_column("payload", "tool", said)}, 2,
                          friction * signals.direction(0) + 30 * said);
    const auto likely = [&](const MatrixXd& measured) {
        return std::ranges::any_of(pushes_in(signals, fitted_effects, measured),
                                   [](const StationaryContact& push) { return push.probability() > 0.5; });
    };
    MatrixXd measured = resting(signals, engine);
    CHECK_FALSE(likely(measured));
    measured.col(0) += 60 * said; // twice what the cause predicts
    CHECK(likely(measured));
}

TEST_CASE("a change of load across a gap of the recording is not a push") {
    DFDYN_SEEDED_ENGINE(engine);
    DiagnosisSignals signals = standing_arm();
    MatrixXd measured = resting(signals, engine);
    // A second run of 3 s, in which the joint rests with another load.
    constexpr Index first = 800, count = 300;
    measured.col(0).segment(first, count).array() += 40;
    const auto likely = [&] {
        return std::ranges::any_of(pushes_in(signals, with_friction(signals, "coulomb"), measured),
                                   [](const StationaryContact& push) { return push.probability() > 0.5; });
    };
    CHECK(likely());
    signals.measured.stretches = {
        {0, first}, {first, count}, {first + count, signals.rows() - first - count}};
    CHECK_FALSE(likely());
}
