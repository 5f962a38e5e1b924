// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/setup_check/rigid_comparison.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Compares the set-up with alternatives by their likelihood, and returns the best alternative if it is much
/// more likely. Each output is fitted by least squares with gravity, a payload of at most 35 % of the arm's
/// mass, inertia and friction of its joint, all with nonnegative factors. The alternatives are:
/// - all outputs, one output, or the position of a joint with the opposite sign;
/// - two outputs, or the positions of two joints, exchanged;
/// - gravity upside down;
/// - positions in degrees.
///
/// The criterion is the sum over the outputs of the logarithm of the variance left by the set-up over the
/// variance left by the alternative: 0.8 and more is a mistake, 0.5 a warning. An exchange is never a mistake
/// for a wrench, nor is gravity for an arm of one joint. Cost: 3 n^2 / 2 times 1,000 rigid-body regressors if
/// some output is not explained, otherwise 2,000.
SetupFindings check_readings(const ArmRecording& arm);

} // namespace dfdyn::tools
