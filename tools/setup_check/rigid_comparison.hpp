// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"

#include <Eigen/Core>

#include <optional>

namespace dfdyn::tools {

/// Rows of a recording with derivatives, T of them: about 10 ms apart or more, at most 1,000, spread evenly.
/// Velocities and accelerations come from the positions (zero phase), whatever columns the recording has.
/// None where fewer than 100 rows have derivatives.
std::optional<RecordedMotion> checked_motion(const Recording& recording);

/// A moving arm's measured outputs and the robot that they should belong to.
struct ArmRecording {
    const Robot& robot;
    const Recording& recording; ///< for the names of its columns
    OutputKind kind;
    RecordedMotion recorded; ///< outputs: N·m for currents of known torque constants
    bool gains_known;        ///< false: outputs are currents, in A

    bool wrench() const { return kind == OutputKind::wrench; }
    /// How many outputs count: of a wrench the forces, for a payload changes the courses of its torques.
    Eigen::Index counted() const { return wrench() ? 3 : recorded.outputs.cols(); }
    Eigen::VectorXd output(Eigen::Index k) const { return recorded.outputs.col(k); }
};

/// Outputs of a robot's rigid body along a motion, T x m, in two parts that add up; N·m also for currents.
/// What is below 1e-9 of the largest is 0.
struct RigidParts {
    Eigen::MatrixXd gravity; ///< what it takes to be stationary at each position
    Eigen::MatrixXd inertia; ///< what the motion adds

    Eigen::VectorXd sum(Eigen::Index k) const { return gravity.col(k) + inertia.col(k); }
};

/// Cost: 2 T rigid-body regressors.
RigidParts rigid_parts(const Robot& robot, OutputKind kind, const RobotMotion& motion);

/// Viscous and Coulomb friction of a joint: velocity and friction_direction(), T x 2.
Eigen::MatrixXd friction_columns(const RobotMotion& motion, Eigen::Index joint);

/// Coulomb friction's course, T: tanh of the velocity over 3 % of its largest magnitude (2e-3 rad/s at
/// least).
Eigen::VectorXd friction_direction(const Eigen::VectorXd& velocity);

/// Whether a joint moves by 0.1 rad (m) or more and turns round `turns` times or more, from a tenth of its
/// largest speed to the opposite.
bool swings(const RobotMotion& motion, Eigen::Index joint, int turns);

/// Turns of a joint from which on what its friction shows is no coincidence.
inline constexpr int certain_turns = 4;

/// Columns that output `k` should be a sum of, with factors that are not negative: the rigid body's, for a
/// joint's output gravity and inertia apart, and its friction.
Eigen::MatrixXd expected_columns(const ArmRecording& arm, const RobotMotion& motion, const RigidParts& parts,
                                 Eigen::Index k);

/// What a joint's output shows of the sign of its friction, beside all that gravity and inertia could be.
enum class FrictionSign { unclear, brakes, drives };

/// Least squares of output `joint` on smooth functions of the positions (each position, its sine and cosine,
/// sines and cosines of sums of neighbouring joints), on all accelerations, and on friction. Clear where
/// friction of one sign leaves less than 60 % of what the other leaves, by 3 % of the variance at least, and
/// all but one of eight parts of the recording that show it agree, at least five. Cost: T (7 n)^2.
FrictionSign friction_sign(const RecordedMotion& recorded, Eigen::Index joint);

/// Columns of output `k` that a point of mass fixed to the last link would have: mass and its first moments,
/// T x 4.
Eigen::MatrixXd payload_columns(const ArmRecording& arm, const RobotMotion& motion, Eigen::Index k);

/// Share of an output's variance that is left by columns with factors that are not negative, and an offset.
double left_by(const Eigen::VectorXd& output, const Eigen::MatrixXd& columns);

} // namespace dfdyn::tools
