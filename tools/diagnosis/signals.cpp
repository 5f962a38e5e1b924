// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals.hpp"

#include "tools/diagnosis/low_pass_kernel.hpp"
#include "tools/robot/regressor.hpp"

#include <utility>

namespace dfdyn::tools {

Eigen::VectorXd DiagnosisSignals::rate(const Eigen::VectorXd& series) const {
    Eigen::VectorXd result(series.size());
    for (const Stretch& stretch : measured.stretches) {
        result.segment(stretch.first, stretch.count) =
            differentiated(series.segment(stretch.first, stretch.count)) * measured.rate_hz;
    }
    return result;
}

Eigen::MatrixXd DiagnosisSignals::of_position(std::size_t joint, const Eigen::VectorXd& change) const {
    const Eigen::VectorXd velocity = rate(change);
    return sensitivity.of(joint, change, velocity, rate(velocity));
}

Eigen::MatrixXd DiagnosisSignals::of_body(Eigen::Index body,
                                          const Eigen::Matrix<double, 10, 1>& parameters) const {
    return unstacked(regressor.middleCols<10>(10 * body) * parameters, outputs());
}

DiagnosisSignals diagnosis_signals(const Robot& robot, OutputKind kind, MeasuredMotion measured) {
    DiagnosisSignals signals;
    signals.robot = robot;
    signals.kind = kind;
    signals.measured = std::move(measured);
    const RobotMotion& motion = signals.measured.motion;
    signals.nominal = rigid_outputs(robot, kind, motion);
    signals.joint_torque =
        signals.wrench() ? rigid_outputs(robot, OutputKind::joint_torque, motion) : signals.nominal;
    signals.regressor = stacked_regressor(robot, kind, motion);
    signals.sensitivity = motion_sensitivity(robot, kind, motion);
    constexpr double slowest = 2e-3; // rad/s
    signals.sign_velocity = (2 * signals.measured.velocity_noise).cwiseMax(slowest);
    return signals;
}

} // namespace dfdyn::tools
