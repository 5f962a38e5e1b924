// SPDX-License-Identifier: Apache-2.0
// An arm that swings, and the contributions of candidates to its outputs.
#pragma once

#include "tests/support/catch.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace dfdyn::tests {

/// Every joint swings with two frequencies; 20 s at 100 Hz without noise.
inline tools::MeasuredMotion swing(Eigen::Index joints) {
    constexpr Eigen::Index rows = 2000;
    tools::MeasuredMotion measured;
    measured.rate_hz = 100;
    measured.time_s = Eigen::VectorXd::LinSpaced(rows, 0, (rows - 1) / 100.0);
    measured.motion = {Eigen::MatrixXd(rows, joints), Eigen::MatrixXd(rows, joints),
                       Eigen::MatrixXd(rows, joints)};
    measured.smoothing_hz = Eigen::VectorXd::Constant(joints, 20);
    measured.velocity_noise = Eigen::VectorXd::Zero(joints);
    measured.outputs = Eigen::MatrixXd::Zero(rows, joints);
    measured.stretches = {{0, rows}};
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
        const double omega = 1.1 + 0.37 * static_cast<double>(joint);
        const Eigen::ArrayXd slow = omega * measured.time_s.array() + static_cast<double>(joint);
        const Eigen::ArrayXd fast = 2.3 * omega * measured.time_s.array();
        measured.motion.position.col(joint) = 0.6 * slow.sin() + 0.2 * fast.cos() + 0.3;
        measured.motion.velocity.col(joint) = omega * (0.6 * slow.cos() - 0.46 * fast.sin());
        measured.motion.acceleration.col(joint) = -omega * omega * (0.6 * slow.sin() + 1.058 * fast.cos());
    }
    return measured;
}

inline tools::DiagnosisSignals signals_of(const tools::Robot& robot, tools::OutputKind kind) {
    return tools::diagnosis_signals(robot, kind, swing(static_cast<Eigen::Index>(robot.joints.size())));
}

/// A fitted model that has only the rigid body, without friction and delays.
inline tools::FittedModel rigid_model(const tools::DiagnosisSignals& signals, bool gains_may_err = true) {
    return {signals.nominal,
            Eigen::MatrixXd::Zero(signals.rows(), static_cast<Eigen::Index>(signals.joints())),
            Eigen::VectorXd::Zero(signals.outputs()), gains_may_err};
}

inline const tools::Candidate& find(const std::vector<tools::Candidate>& candidates,
                                    const std::string& effect, const std::string& where) {
    const auto found = std::ranges::find_if(
        candidates, [&](const tools::Candidate& one) { return one.effect == effect && one.where == where; });
    REQUIRE(found != candidates.end());
    return *found;
}

inline Eigen::MatrixXd contribution(const tools::DiagnosisSignals& signals, const tools::Candidate& candidate,
                                    std::size_t column) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(signals.rows(), signals.outputs());
    for (const tools::EffectColumn::Part& part : candidate.columns[column].parts) {
        sum.col(part.output) += part.series;
    }
    return sum;
}

/// Compares all rows except the 10 at either end, where finite differences are less accurate.
inline void check_same(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected, double tolerance) {
    const Eigen::Index inner = found.rows() - 20;
    CHECK((found - expected).middleRows(10, inner).cwiseAbs().maxCoeff() <
          tolerance * expected.middleRows(10, inner).cwiseAbs().maxCoeff());
}

} // namespace dfdyn::tests
