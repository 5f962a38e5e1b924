// SPDX-License-Identifier: Apache-2.0
// Parameters that every model of the diagnosis has and that are no finding.
#include "tools/diagnosis/search/nuisance_parameters.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/verdict/findings.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace nuisance_parameters_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double level = 5;   // N·m
constexpr double noise = 0.1; // N·m

/// Dry friction of a joint whose bristles bend by `bend` (rad) before they slide. Integrated with a hundred
/// steps between two rows.
VectorXd bristle_friction(const MeasuredMotion& measured, Index joint, double bend) {
    constexpr int steps = 100;
    const auto position = measured.motion.position.col(joint);
    VectorXd friction(position.size());
    double share = 0; // of the level
    friction[0] = 0;
    for (Index row = 1; row < position.size(); ++row) {
        const double way = (position[row] - position[row - 1]) / steps;
        for (int step = 0; step < steps; ++step) {
            share += way / bend - std::abs(way) / bend * share;
        }
        friction[row] = level * share;
    }
    return friction;
}

/// Returns the likely findings for torques (T x 6), as effect@place.
std::vector<std::string> likely(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured) {
    const FittedEffects effects = find_effects(signals, measured, {});
    const Eigen::MatrixXd rest = measured - signals.nominal - effects.total_contribution(signals);
    std::vector<std::string> names;
    for (const Finding& finding : findings_of(signals, effects, {}, rest, joint_names("tau", 6))) {
        if (finding.confidence >= 0.5) {
            names.push_back(finding.effect + "@" + finding.where);
        }
    }
    std::ranges::sort(names);
    return names;
}

Eigen::MatrixXd noisy(Eigen::MatrixXd torques, std::mt19937_64& engine) {
    std::normal_distribution<double> normal(0, noise);
    for (double& one : torques.reshaped()) {
        one += normal(engine);
    }
    return torques;
}

TEST_CASE("the way in which friction builds up after a reversal is not likely to be another cause") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    for (const double bend : {5e-4, 1e-3, 1.7e-3}) {
        CAPTURE(bend);
        Eigen::MatrixXd torques = signals.nominal;
        torques.col(1) += bristle_friction(signals.measured, 1, bend);
        CHECK(likely(signals, noisy(torques, engine)) == std::vector<std::string>{"coulomb_friction@joint2"});
    }
}

TEST_CASE("a real delay of a joint with friction remains likely") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    Eigen::MatrixXd torques = signals.nominal;
    torques.col(1) += bristle_friction(signals.measured, 1, 5e-4);
    constexpr Index late = 3; // rows
    const Index rows = torques.rows();
    torques.col(1).tail(rows - late) = torques.col(1).head(rows - late).eval();
    const std::vector<std::string> found = likely(signals, noisy(torques, engine));
    CHECK(std::ranges::count(found, "delay@actuator2") == 1);
}

TEST_CASE("without friction nothing builds up") {
    DFDYN_SEEDED_ENGINE(engine);
    const DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    const FittedEffects effects = find_effects(signals, noisy(signals.nominal, engine), {});
    CHECK(effects.named_effects().empty());
    CHECK(effects.reported_contribution(signals).cwiseAbs().maxCoeff() < noise);
}

} // namespace nuisance_parameters_test
