// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Names what plain least squares finds (`fit_moving_rows`, on the whole recording) at each joint where it is
/// the extended model. Its friction, rotor inertia and offset become the findings at that joint. What else
/// was found at the joint or its actuator gets a confidence below 0.5, except contacts, and a gain of the
/// actuator that least squares shows, too. Joints that hardly move, or for less than ten blocks of time, keep
/// their findings. Sets `textbook` of the diagnosis and `extended`. Cost: O(25 T) per output.
void name_by_least_squares(DiagnosisWork& work);

} // namespace dfdyn::tools
