// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/setup_check/rigid_comparison.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Compares the columns as they are with other readings of them, by least squares of each output on gravity,
/// inertia and friction of its joint with factors that are not negative, and finds the reading that explains
/// all outputs best, where it is far better:
/// - two outputs, or the positions of two joints, exchanged;
/// - outputs, or the position of a joint, of the wrong sign, where friction shows it, too;
/// - gravity upside down, where two outputs or more show it and none the opposite;
/// - positions in degrees.
/// Mistakes: a reading that leaves less than half of each output that it is about, of more than 30 % on
/// average. Warnings: an exchange that leaves less than 60 % of that, and a sign that only gravity shows.
/// Cost: n^2 / 2 times 2,000 rigid-body regressors where some output is not explained, else 2,000.
SetupFindings check_readings(const ArmRecording& arm);

} // namespace dfdyn::tools
