// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"
#include "tools/setup_check/rigid_comparison.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

// The checks that check_setup() runs.

/// Detects a column `t` that is not in seconds, by the median time step and the speed of the fastest joint
/// (99 % quantile). Mistakes: rows at least 2 s apart; rows at least 0.19 s apart while no joint is faster
/// than 0.03 rad/s; rows less than 20 µs apart while a joint is faster than 60 rad/s. Cost: O(rows log rows).
SetupFindings check_clock(const Recording& recording);

/// Detects angles wrapped at half a turn: neighbouring rows that differ by 2 pi (360) within 3 % while the
/// joint moves less than a tenth of a turn before and after. Cost: O(rows).
SetupFindings check_wrapping(const Recording& recording);

/// Detects implausible outputs: more than 1000 A, or whole numbers above 200 (a warning), indicate mA; more
/// than 20,000 N·m indicates mN·m. The 99.9 % quantile of the magnitudes is used. Cost: O(rows).
SetupFindings check_output_unit(const Recording& recording, OutputKind outputs);

/// Detects positions in degrees or thousandths by the joints' limits: a mistake beyond six times the limits
/// and two turns (5 m), a warning beyond 1.2 times the limits. Without limits or without a robot (null), at
/// least three joints, and at least half of the joints, beyond two turns indicate degrees. Cost: O(rows).
SetupFindings check_position_unit(const Recording& recording, const Robot* robot);

/// Returns the remedy for columns of `quantity` in `unit`, both as in --units: `multiply by pi/180, or
/// --units q=deg`.
std::string unit_remedy(const std::string& quantity, const std::string& unit);

/// Returns the difference between the largest and the smallest value of a column.
double travel(const Columns& columns, std::size_t index);

/// Returns the largest magnitude in a column.
double largest_magnitude(const Columns& columns, std::size_t index);

/// Detects outputs with one value in every row while the arm moves by 0.1 rad (m). A mistake if the output's
/// own joint moves that far and other outputs vary. Otherwise a warning, because all motors may be off, and
/// an axis of a wrench may have no load. Joints that move no mass are ignored (`robot` may be null). Also a
/// mistake: one value for 2 s or more while the joint moves that far. Cost: O(rows).
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
/// friction_sign() confirms it. A wrench has no friction of joints.
SetupFindings check_friction_sign(const Recording& recording, const RecordedMotion& recorded,
                                  OutputKind outputs);

/// Detects positions in degrees for one or two joints beyond two turns: a mistake if gravity as a function of
/// angles in degrees leaves less than half of the variance that it leaves in radians.
SetupFindings check_degrees_by_gravity(const Recording& recording, const RecordedMotion& recorded);

/// Detects outputs in a wrong unit by their ratio to the rigid body's, if that explains half of the variance
/// left by friction. A mistake requires that two outputs or more agree (within a factor of 10) on a factor of
/// 50 too large or too small; for an arm of one joint, and for a wrench, a factor of 300. A warning if one
/// joint of several is 300 times too large. For currents with unknown torque constants: from 50 A/N·m, a
/// single joint from 200; or below 1 A per 500 N·m.
SetupFindings check_output_size(const ArmRecording& arm);

/// Compares the set-up with alternatives by their likelihood, and returns the best alternative if it is much
/// more likely. Each output is fitted by least squares with gravity, a payload of at most 35 % of the arm's
/// mass, inertia and friction of its joint, all with nonnegative factors. The alternatives are:
/// - all outputs, one output, or the position of a joint with the opposite sign;
/// - two outputs, or the positions of two joints, exchanged;
/// - gravity upside down;
/// - positions in degrees.
///
/// The criterion is the sum over the outputs of the logarithm of the variance left by the set-up over the
/// variance left by the alternative: 0.8 and more is a mistake, 0.5 a warning. For a wrench, exchanges and
/// signs of positions are never a mistake, nor is gravity for an arm of one joint. Cost: 3 n^2 / 2 times
/// 1,000 rigid-body regressors if some output is not explained, otherwise 2,000.
SetupFindings check_readings(const ArmRecording& arm);

/// Detects a robot's file that does not belong to the recording: a mistake if the file's rigid body with any
/// payload leaves a large residual at the gravity-loaded joints, and smooth functions of the motion a far
/// smaller one. Each joint is compared in the rows in which it moves, if they are enough for this number of
/// functions. Joints without gravity in the file, and wrenches, are not compared. Cost: T (8 n)^2 per output.
SetupFindings check_robot_match(const ArmRecording& arm);

} // namespace dfdyn::tools
