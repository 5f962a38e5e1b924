// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/measured_motion.hpp"
#include "tools/diagnosis/signals/rigid_model.hpp"

namespace dfdyn::tools {

/// What candidate effects are made of.
struct DiagnosisSignals {
    Robot robot;
    OutputKind kind = OutputKind::joint_torque;
    MeasuredMotion measured;
    Eigen::MatrixXd nominal; ///< T x m: the rigid body along the motion; N·m also for currents
    Eigen::MatrixXd
        joint_torque;          ///< T x n: the rigid body's torques; `nominal` unless the outputs are a wrench
    Eigen::MatrixXd regressor; ///< T m x 10 bodies, rows t m + k: of the rigid body
    MotionSensitivity sensitivity;
    Eigen::MatrixXd joint_inertia; ///< T x n, kg·m²: of each joint while the others are held
    Eigen::VectorXd sign_velocity; ///< n, rad/s: below it the direction of motion is not certain

    Eigen::Index rows() const { return measured.time_s.size(); }
    std::size_t joints() const { return robot.joints.size(); }
    Eigen::Index outputs() const { return nominal.cols(); }
    bool wrench() const { return kind == OutputKind::wrench; }
    /// Which way a joint moves, from -1 to 1; nearly 0 where that is not certain. T.
    Eigen::VectorXd direction(Eigen::Index joint) const;

    /// Low-passed at `cutoff_hz`, stretch by stretch; as it is where the rate shows no higher frequencies.
    Eigen::VectorXd below(double cutoff_hz, const Eigen::VectorXd& series) const;
    /// Derivative per second, stretch by stretch.
    Eigen::VectorXd rate(const Eigen::VectorXd& series) const;
    /// (series(t - delay) - series(t)) / delay, stretch by stretch; without a delay, minus the derivative.
    Eigen::VectorXd per_delay(const Eigen::VectorXd& series, double delay_s) const;
    /// The outputs that a change of the true position of `joint` brings, T x m.
    Eigen::MatrixXd of_position(std::size_t joint, const Eigen::VectorXd& change) const;
    /// The outputs of a body with these ten parameters that is fixed to link `body` (0: the first that
    /// counts).
    Eigen::MatrixXd of_body(Eigen::Index body, const Eigen::Matrix<double, 10, 1>& parameters) const;
};

DiagnosisSignals diagnosis_signals(const Robot& robot, OutputKind kind, MeasuredMotion measured);

} // namespace dfdyn::tools
