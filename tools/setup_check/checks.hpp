// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"
#include "tools/setup_check/rigid_body/rigid_comparison.hpp"
#include "tools/setup_check/setup_finding.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

// The checks that check_setup() runs.

/// Detects a column `t` that is not in seconds, by the median time step and the speed of the fastest joint
/// (99 % quantile). Mistakes: rows at least 2 s apart; rows at least 0.19 s apart while no joint is faster
/// than 0.03 rad/s; rows less than 20 µs apart while a joint is faster than 60 rad/s. Cost: O(rows log rows).
SetupFindings check_clock(const Recording& recording);

/// Detects angles wrapped at half a turn: neighbouring rows that differ by 2 pi (360) within 3 % while the
/// joint moves less than a tenth of a turn before and after. `robot` (may be null) has the recording's
/// joints; its prismatic joints are not checked. Cost: O(rows).
SetupFindings check_wrapping(const Recording& recording, const Robot* robot);

/// Detects implausible outputs: more than 1000 A, or whole numbers above 200 (a warning), indicate mA; more
/// than 20,000 N·m, and than 20 times an upper bound of the effect of gravity on `robot` (may be null),
/// indicates mN·m. The 99.9 % quantile of the magnitudes is used. Cost: O(rows).
SetupFindings check_output_unit(const Recording& recording, OutputKind outputs, const Robot* robot);

/// Detects positions in degrees or thousandths by the joints' limits: a mistake beyond six times the limits
/// and two turns (5 m), a warning beyond 1.2 times the limits. The unit is that of all joints that turn, or
/// slide. Without limits or without a robot (null), at least three joints, and at least half of the joints,
/// beyond two turns indicate degrees; a warning if joints of the robot that are continuous, or within their
/// limits, are needed for this number.
/// `robot` has the recording's joints. Cost: O(rows).
SetupFindings check_position_unit(const Recording& recording, const Robot* robot);

/// Unit of a joint's positions: rad (m), degrees, or mrad (mm).
enum class JointUnit { si, degrees, thousandths };

/// Returns the remedy for positions in these units, one per joint, of which one at least is not `si`:
/// `multiply q1 by pi/180, divide q2 by 1000, or --units 'q=deg|mm'`.
std::string position_remedy(const Recording& recording, const Robot& robot,
                            const std::vector<JointUnit>& units);

/// Returns the remedy for columns of `quantity` in `unit`, both as in --units: `multiply by pi/180, or
/// --units q=deg`.
std::string unit_remedy(const std::string& quantity, const std::string& unit);

/// Returns the difference between the largest and the smallest value of a column.
double travel(const Columns& columns, std::size_t index);

/// Returns the largest magnitude in a column.
double largest_magnitude(const Columns& columns, std::size_t index);

/// Detects rows that repeat all positions and outputs for 0.2 s and more, before or after a jump of a
/// position: a mistake, because a recorder stopped. A jump is longer than three times any step elsewhere,
/// than ten times the joint's median step, and than 0.02 rad (m). Cost: O(rows log rows).
SetupFindings check_filler_rows(const Recording& recording);

/// Detects outputs with one value in every row while the arm moves by 0.1 rad (m). A mistake if the output's
/// own joint moves that far and other outputs vary. Otherwise a warning, because all motors may be off, and
/// an axis of a wrench may have no load. Joints that move no mass are ignored (`robot` may be null). Also a
/// mistake: one value for 2 s or more while the joint moves that far, unless the output is saturated (10 s in
/// steps of more than 1 % of its range, also at its limit). Cost: O(rows).
SetupFindings check_dead_outputs(const Recording& recording, OutputKind outputs, const Robot* robot);

/// Detects outputs that stay at their largest or smallest value, at least three rows in a row and in 10 rows
/// in all, while the arm moves. A mistake if more rows are at this value than within the nearest 2 % of the
/// output's range: without saturation, values close to it would be more frequent. Wrenches are not checked.
/// Cost: O(rows).
SetupFindings check_saturated_outputs(const Recording& recording, OutputKind outputs);

/// Detects positions that are multiples of more than 6.5 mrad (mm), which is coarser than ten bits a turn.
/// Cost: O(rows log rows).
SetupFindings check_quantised_positions(const Recording& recording);

/// Detects time stamps that deviate from the sample times by 15 % of a step and more (rms), for example
/// rounded ones. While two joints or more move, the deviations from smooth motions are then the velocities
/// times one common time. Rows 25 ms apart and more are not checked. Cost: O(rows).
SetupFindings check_stamps(const Recording& recording);

/// Detects outputs whose friction accelerates the joint instead of braking it, without a robot: a mistake if
/// friction_sign() is certain, otherwise a warning. A wrench has no friction of joints.
SetupFindings check_friction_sign(const Recording& recording, const RecordedMotion& recorded,
                                  OutputKind outputs);

/// Detects positions in degrees for one or two joints beyond two turns: a mistake if gravity as a function of
/// angles in degrees leaves less than half of the variance that it leaves in radians.
SetupFindings check_degrees_by_gravity(const Recording& recording, const RecordedMotion& recorded);

/// Ratio of each output to the rigid body's, as a magnitude; empty where the rigid body explains less than
/// half of the variance left by friction, and for joints without gravity that reverse less than four times.
using OutputSizes = std::vector<std::optional<double>>;

/// `parts`: the rigid body along the recording.
OutputSizes output_sizes(const ArmRecording& arm, const RigidParts& parts);

/// Detects outputs in a wrong unit by `sizes`, the output_sizes(). A mistake requires that two outputs or
/// more agree (within a factor of 10) on a factor of 50 too large or too small; for an arm of one joint, and
/// for a wrench, a factor of 300. A warning if one joint of several is 300 times too large. For currents with
/// unknown torque constants: from 50 A/N·m, a single joint from 200; or below 1 A per 500 N·m. Outputs more
/// than 300 times too small indicate masses in grams, others torques of the motors. Too large
/// outputs are only a warning if none exceeds 8 times (8 A/N·m) that of the rigid body with the heaviest
/// plausible payload.
SetupFindings check_output_size(const ArmRecording& arm, const RigidParts& parts, const OutputSizes& sizes);

/// Detects smaller factors, from 8 on, as of motor torques before the gears: their median over the joints
/// that move against gravity, or over all if there are none. A warning, and a mistake if outputs are too
/// small and most joints that move against gravity agree within a factor of 2; a payload or a rotor can make
/// them too large. Not for a wrench, and not for currents with unknown torque constants.
SetupFindings check_output_scale(const ArmRecording& arm, const RigidParts& parts, const OutputSizes& sizes);

/// Detects a common delay between outputs and positions: a warning if outputs of other rows, from 8 ms and
/// 1.5 rows up to 0.25 s earlier or later, leave a clearly smaller residual of rigid body and friction (mean
/// logarithm of the ratio below -0.15), and at least two joints, and half of the moving ones, have their
/// smallest residual there. `rows` has the row of each state of `arm`. Not for a wrench. Cost: 100 T n.
SetupFindings check_output_delay(const ArmRecording& arm, const RigidParts& parts,
                                 const std::vector<std::size_t>& rows);

/// Compares the set-up with alternatives by their likelihood, and returns the best alternative if it is much
/// more likely. Each output is fitted by least squares with gravity, a payload of at most 35 % of the arm's
/// mass, inertia and friction of its joint, all with nonnegative factors. The alternatives are:
/// - all outputs, one output, or the position of a joint with the opposite sign;
/// - two outputs, or the positions of two joints, exchanged;
/// - gravity upside down;
/// - positions in degrees: of all joints that turn, of those beyond one turn, of one of these;
/// - if the best of these leaves 3 % of the variance and more: the zero of one joint, 90 or 180 degrees away.
///
/// Outputs are compared in the moving_rows(). An exchange is a mistake only if gravity, friction
/// or inertia show it, otherwise a warning. The criterion is the sum over the outputs of the logarithm
/// of the variance left by the set-up over the variance left by the alternative: 0.8 and more is a mistake,
/// 0.5 a warning. For a wrench, exchanges and signs of positions are never a mistake, nor is a zero that
/// leaves much of it; nor is gravity for an arm of one joint. Cost: about n^2 / 2 + 5 n alternatives of 2,000
/// rigid-body regressors each if some output is not explained, otherwise none.
SetupFindings check_readings(const ArmRecording& arm, const RigidParts& parts);

/// Compares the set-up with zeros of one joint that are 90 or 180 degrees away, by the same criterion. A zero
/// is named only if it leaves less than 15 % of the variance of each joint that reverses twice, or 3 % on
/// average: gravity along another axis, and another robot, can look like a zero at some joints.
SetupFindings check_zeros(const ArmRecording& arm, const RigidParts& parts);

/// Detects a robot's file that does not belong to the recording: a mistake if the file's rigid body with any
/// payload leaves a large residual at the gravity-loaded joints, and smooth functions of the motion a far
/// smaller one. Each joint is compared in the rows in which it moves, if they are enough for this number of
/// functions. Both models have Coulomb friction with a sharp and with a soft transition. Joints without
/// gravity in the file, and wrenches, are not compared. Cost: T (8 n)^2 per output.
SetupFindings check_robot_match(const ArmRecording& arm, const RigidParts& parts);

} // namespace dfdyn::tools
