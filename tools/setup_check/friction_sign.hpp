// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/motion.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// Sign of the friction in a joint's output, in addition to any gravity and inertia.
enum class FrictionSign { unclear, brakes, drives };

/// Sign of a joint's friction, and whether no inertia can look like it.
struct FrictionEvidence {
    FrictionSign sign = FrictionSign::unclear;
    bool certain = false;
};

/// Fits output `joint` by least squares with smooth functions of the positions (each position, its sine and
/// cosine, sines and cosines of sums of neighbouring joints), all accelerations, and friction. The sign is
/// clear if all of this holds:
/// - the joint reverses four times;
/// - friction of one sign leaves less than 60 % of the residual of the other, a difference of at least 1 % of
///   the variance;
/// - in all but one of the (eight) parts of the recording with visible friction, at least five, it has this
///   sign;
/// - the step of Coulomb friction has this sign, in addition to a viscous friction of any sign.
///
/// It is certain if the second condition also holds in a fit that has the products of all velocities, too,
/// and at least twice as many rows as functions. Cost: T (8 n)^2; for a joint with friction T (8 n + n^2 /
/// 2)^2.
FrictionEvidence friction_sign(const RecordedMotion& recorded, Eigen::Index joint);

} // namespace dfdyn::tools
