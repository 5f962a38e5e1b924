// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/signals.hpp"

#include "tools/diagnosis/signals/low_pass_kernel.hpp"
#include "tools/diagnosis/signals/response_bandwidth.hpp"
#include "tools/diagnosis/signals/row_weight.hpp"
#include "tools/robot/dynamics/friction_direction.hpp"
#include "tools/robot/regressor.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

bool DiagnosisSignals::hardly_moves(std::size_t joint) const {
    constexpr double least_rad = 0.05;
    constexpr double least_m = 0.005;
    const auto position = measured.motion.position.col(static_cast<Eigen::Index>(joint));
    return position.maxCoeff() - position.minCoeff() < (robot.joints[joint].prismatic ? least_m : least_rad);
}

Eigen::VectorXd DiagnosisSignals::direction(Eigen::Index joint) const {
    return friction_direction(measured.motion.velocity.col(joint), sign_velocity[joint]);
}

Eigen::VectorXd DiagnosisSignals::below(double cutoff_hz, const Eigen::VectorXd& series) const {
    const double cutoff = cutoff_hz / measured.rate_hz;
    if (cutoff >= 0.5 || series.isZero(0)) {
        return series;
    }
    const Eigen::VectorXd kernel = low_pass_kernel(cutoff);
    Eigen::VectorXd result(series.size());
    for (const Stretch& stretch : measured.stretches) {
        result.segment(stretch.first, stretch.count) =
            filtered(series.segment(stretch.first, stretch.count), kernel);
    }
    return result;
}

Eigen::VectorXd DiagnosisSignals::rate(const Eigen::VectorXd& series) const {
    Eigen::VectorXd result(series.size());
    for (const Stretch& stretch : measured.stretches) {
        result.segment(stretch.first, stretch.count) =
            differentiated(series.segment(stretch.first, stretch.count)) * measured.rate_hz;
    }
    return result;
}

Eigen::VectorXd DiagnosisSignals::per_delay(const Eigen::VectorXd& series, double delay_s) const {
    const Eigen::VectorXd slope = rate(series);
    if (delay_s <= 0) {
        return -slope;
    }
    const double step_s = 1 / measured.rate_hz;
    Eigen::VectorXd result(series.size());
    for (const Stretch& stretch : measured.stretches) {
        for (Eigen::Index row = stretch.first; row < stretch.first + stretch.count; ++row) {
            const double at = std::max(0.0, static_cast<double>(row - stretch.first) - delay_s / step_s);
            const auto before = stretch.first + std::min(static_cast<Eigen::Index>(at), stretch.count - 2);
            const double part = at - static_cast<double>(before - stretch.first);
            // cubic Hermite interpolation between two rows, from their values and derivatives
            const double rise = series[before + 1] - series[before];
            const double bend =
                part * (1 - part) *
                ((1 - part) * (step_s * slope[before] - rise) - part * (step_s * slope[before + 1] - rise));
            result[row] = (series[before] + part * rise + bend - series[row]) / delay_s;
        }
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
    signals.measured.weight = signals.wrench() ? end_row_weight(signals.measured).replicate(1, 6).eval()
                                               : joint_row_weight(robot, signals.measured, signals.nominal);
    signals.regressor = stacked_regressor(robot, kind, motion);
    signals.joint_inertia = joint_inertias(robot, motion);
    signals.sensitivity = motion_sensitivity(robot, kind, motion);
    constexpr double slowest = 2e-3; // rad/s
    signals.sign_velocity = (2 * signals.measured.velocity_noise).cwiseMax(slowest);
    signals.measured.response_bandwidth_hz = response_bandwidth_hz(signals);
    return signals;
}

} // namespace dfdyn::tools
