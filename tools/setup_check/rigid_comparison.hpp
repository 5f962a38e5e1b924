// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Measured outputs beside those of a robot's rigid body, at up to 2,000 rows spread over a recording.
struct RigidComparison {
    const Robot& robot; ///< must outlive this
    OutputKind kind;
    std::vector<std::string> output_names;
    RobotMotion motion;
    Eigen::MatrixXd measured;  ///< T x m
    Eigen::MatrixXd nominal;   ///< T x m: the rigid body's; N·m also for currents
    Eigen::MatrixXd direction; ///< T x n: tanh(velocity / sign velocity)

    /// `sign_velocity`: n, rad/s, > 0. Cost: 2,000 rigid-body regressors at most.
    RigidComparison(const Robot& robot, OutputKind kind, std::vector<std::string> output_names,
                    const RobotMotion& motion, const Eigen::MatrixXd& measured,
                    const Eigen::VectorXd& sign_velocity);

    Eigen::Index outputs() const { return measured.cols(); }
    bool wrench() const { return kind == OutputKind::wrench; }
};

/// The rigid body's outputs along a motion, T x m; N·m also for currents.
Eigen::MatrixXd nominal_outputs(const Robot& robot, OutputKind kind, const RobotMotion& motion);

/// Least squares of an output on the rigid body's output, and of joint outputs also on the joint's friction.
struct OutputFit {
    double gain = 0;      ///< of the rigid body's output
    double explained = 0; ///< share of what the other columns leave that the rigid body's output explains
    double friction_power = 0; ///< mean of friction times velocity: > 0 dissipates, 0 for a wrench
    double left = 1;           ///< share of the output's variance that no column explains
};

/// Fits measured output `output` by nominal output `other`, an offset, and viscous and Coulomb friction of
/// joint `other`, with `spring` also the joint's position.
OutputFit fit_output(const RigidComparison& comparison, Eigen::Index output, Eigen::Index other, bool spring);

} // namespace dfdyn::tools
