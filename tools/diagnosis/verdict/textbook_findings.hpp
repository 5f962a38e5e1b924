// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Fits plain least squares to the moving rows of each output of the whole recording: `textbook`. Names what
/// it finds at each joint where it is the extended model, because the causes found err more: its friction,
/// rotor inertia and offset replace the findings at that joint, and what else was found there is unlikely.
/// Sets `extended` and, at these outputs, `rest`. `gains_known`: torques were measured, or currents with
/// given torque constants, so that the rigid body's factor is near 1.
///
/// All moving rows have the same weight. Deviations are those of the sums over each second, so that they
/// include coloured noise and what changes during the recording. Cost: O(25 T) per output.
void name_by_least_squares(DiagnosisWork& work, bool gains_known);

} // namespace dfdyn::tools
