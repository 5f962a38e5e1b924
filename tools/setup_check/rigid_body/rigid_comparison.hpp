// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Rows of a recording with derivatives.
struct CheckedMotion {
    RecordedMotion recorded;
    std::vector<std::size_t> rows; ///< the recording's row of each state, T
};

/// Returns rows of a recording with derivatives, T of them: at least about 10 ms apart, at most 1,000, evenly
/// spread. Velocities and accelerations are computed from the positions (zero phase), even if the recording
/// has such columns. Returns nothing if fewer than 100 rows have derivatives.
std::optional<CheckedMotion> checked_motion(const Recording& recording);

/// Returns the standard deviation of the noise in the accelerations of checked_motion(), rad/s^2 (m/s^2). It
/// is estimated from the fourth differences of the joint's positions, of which motion is a small part: an
/// upper bound. For the noise of a quadratic fit's curvature see Savitzky and Golay, Anal. Chem. 36 (1964).
double acceleration_noise(const Recording& recording, Eigen::Index joint);

/// The measured outputs of a moving arm, and the robot of the set-up.
struct ArmRecording {
    const Robot& robot;
    const Recording& recording; ///< for the names of its columns
    OutputKind kind;
    RecordedMotion recorded; ///< outputs: N·m for currents with known torque constants
    bool gains_known;        ///< false: outputs are currents, in A

    bool wrench() const { return kind == OutputKind::wrench; }
    /// Number of outputs used: for a wrench only the forces, because a payload changes the shape of its
    /// torques.
    Eigen::Index counted() const { return wrench() ? 3 : recorded.outputs.cols(); }
    Eigen::VectorXd output(Eigen::Index k) const { return recorded.outputs.col(k); }
};

/// Outputs of a robot's rigid body along a motion, T x m, as a sum of two parts; N·m also for currents.
/// Values below 1e-9 of the largest are 0, and the gravity of an axis below 1e-4: rounded angles tilt it.
struct RigidParts {
    Eigen::MatrixXd gravity; ///< torque at standstill at each position
    Eigen::MatrixXd inertia; ///< additional torque of the motion
    /// The arm's gravity plus gravity and inertia of the heaviest plausible payload, with its
    /// centre at each corner of a cube of 0.4 m around the tip, and with the moment of inertia of a point
    /// mass there or at the tip: 16 matrices, none for a wrench.
    std::vector<Eigen::MatrixXd> loaded;

    Eigen::VectorXd sum(Eigen::Index k) const { return gravity.col(k) + inertia.col(k); }
};

/// Returns the outputs of the rigid body along `motion`, T states. Cost: 2 T rigid-body regressors.
RigidParts rigid_parts(const Robot& robot, OutputKind kind, const RobotMotion& motion);

/// Returns the norm of each column's deviation from its mean.
Eigen::VectorXd deviations(const Eigen::MatrixXd& columns);

/// Least deviation of gravity's torque at a joint that counts as loaded by gravity.
inline constexpr double least_gravity_share = 0.1; ///< of the largest deviation of gravity

/// Viscous and Coulomb friction of a joint: velocity and friction_direction(), T x 2.
Eigen::MatrixXd friction_columns(const RobotMotion& motion, Eigen::Index joint);

/// Shape of Coulomb friction, T: tanh of the velocity divided by 3 % of its largest magnitude (at least 2e-3
/// rad/s).
Eigen::VectorXd friction_direction(const Eigen::VectorXd& velocity);

/// Smooth functions of the motion: each position, its sine and cosine, those of sums of two and three
/// neighbours, and the accelerations, T x (at most 8 n).
Eigen::MatrixXd smooth_columns(const RobotMotion& motion);

/// Returns whether a joint moves by at least 0.1 rad (m) and reverses at least `turns` times, from a tenth of
/// its largest speed to the opposite, and by 0.01 rad (m) or more.
bool swings(const RobotMotion& motion, Eigen::Index joint, int turns);

/// Returns the rows in which a joint is faster than 3 % of its largest speed (and 2e-3 rad/s), all rows if
/// none moves by 0.1 rad (m). While the arm rests, static friction may bear any torque up to the break-away
/// torque, a different one in each posture, which looks like gravity.
std::vector<Eigen::Index> moving_rows(const RobotMotion& motion);

/// Number of a joint's reversals after which its friction is reliable evidence.
inline constexpr int certain_turns = 4;

/// Returns the columns whose sum with nonnegative factors should be output `k`: the rigid body's for a
/// wrench; for a joint's output gravity, gravity with payloads, inertia and friction.
Eigen::MatrixXd expected_columns(const ArmRecording& arm, const RobotMotion& motion, const RigidParts& parts,
                                 Eigen::Index k);

/// Returns the share of an output's variance that remains after a fit with nonnegative factors and an offset.
double left_by(const Eigen::VectorXd& output, const Eigen::MatrixXd& columns);

} // namespace dfdyn::tools
