// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/measured_motion.hpp"
#include "tools/diagnosis/signals/rigid_model.hpp"

namespace dfdyn::tools {

/// The signals from which candidate effects are computed.
struct DiagnosisSignals {
    Robot robot;
    OutputKind kind = OutputKind::joint_torque;
    MeasuredMotion measured;
    Eigen::MatrixXd nominal; ///< T x m: rigid-body outputs along the motion; N·m also for currents
    Eigen::MatrixXd
        joint_torque;          ///< T x n: the rigid body's torques; `nominal` unless the outputs are a wrench
    Eigen::MatrixXd regressor; ///< T m x 10 bodies, rows t m + k: regressor of the rigid body
    MotionSensitivity sensitivity;
    Eigen::MatrixXd joint_inertia; ///< T x n, kg·m²: inertia of each joint with the others fixed
    Eigen::VectorXd sign_velocity; ///< n, rad/s: below it the direction of motion is uncertain

    Eigen::Index rows() const { return measured.time_s.size(); }
    std::size_t joints() const { return robot.joints.size(); }
    Eigen::Index outputs() const { return nominal.cols(); }
    bool wrench() const { return kind == OutputKind::wrench; }
    /// Returns whether a joint travels less than 0.05 rad (5 mm), so that static friction determines its
    /// torque.
    bool hardly_moves(std::size_t joint) const;
    /// Returns the direction of motion (T) of a joint, from -1 to 1; nearly 0 where it is uncertain.
    Eigen::VectorXd direction(Eigen::Index joint) const;

    /// Returns the series, low-pass filtered at `cutoff_hz` segment by segment. Returns it unchanged if its
    /// sampling rate is too low for higher frequencies.
    Eigen::VectorXd below(double cutoff_hz, const Eigen::VectorXd& series) const;
    /// Returns the time derivative (1/s), segment by segment.
    Eigen::VectorXd rate(const Eigen::VectorXd& series) const;
    /// Returns (series(t - delay) - series(t)) / delay, segment by segment. For a delay of zero, returns
    /// minus the derivative.
    Eigen::VectorXd per_delay(const Eigen::VectorXd& series, double delay_s) const;
    /// Returns the change of the outputs (T x m) for a change of the true position of `joint`.
    Eigen::MatrixXd of_position(std::size_t joint, const Eigen::VectorXd& change) const;
    /// Returns the outputs of a body with these ten parameters that is fixed to link `body` (0: the first
    /// link that influences the outputs).
    Eigen::MatrixXd of_body(Eigen::Index body, const Eigen::Matrix<double, 10, 1>& parameters) const;
    /// Returns the index of the link (from 0) that `body` is.
    std::size_t link_of(Eigen::Index body) const {
        return joints() - static_cast<std::size_t>(regressor.cols() / 10 - body);
    }
};

DiagnosisSignals diagnosis_signals(const Robot& robot, OutputKind kind, MeasuredMotion measured);

} // namespace dfdyn::tools
