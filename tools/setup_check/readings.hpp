// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/setup_check/rigid_comparison.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Compares the columns with alternative interpretations, and returns the one that explains all outputs best
/// if it is much better. Each output is fitted by least squares with gravity, inertia and friction of its
/// joint, with nonnegative factors. The alternatives are:
/// - two outputs, or the positions of two joints, exchanged;
/// - outputs, or the position of a joint, with the wrong sign, if friction confirms it;
/// - gravity upside down, if two outputs or more show it and none the opposite;
/// - positions in degrees.
///
/// A mistake requires that less than half of the residual of each affected output remains, which must be
/// above 30 % on average before. Warnings: an exchange with less than 60 % remaining, and a sign that only
/// gravity shows. Cost: n^2 / 2 times 2,000 rigid-body regressors if some output is not explained, otherwise
/// 2,000.
SetupFindings check_readings(const ArmRecording& arm);

} // namespace dfdyn::tools
