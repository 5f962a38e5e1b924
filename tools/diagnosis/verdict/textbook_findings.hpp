// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Returns whether the gears of an arm are real ones: at half of the joints that move, and at two at least,
/// no effect is exactly right.
bool friction_everywhere(const DiagnosisWork& work);

/// Returns the probability that the true value is within half of the estimate `value`.
double probability_of_size(double value, double deviation);

/// Makes findings of the friction, rotor inertia and offset that least squares finds on the whole recording:
/// at each joint where plain least squares is the extended model (`fit_moving_rows`), or, for an arm with
/// real gears, at every joint (`fit_arm`). Other findings at the joint or its actuator get a confidence below
/// 0.5, except contacts and a gain that the fit confirms. Joints that hardly move, or for less than ten
/// blocks of time, keep their findings. Sets `textbook` of the diagnosis and `extended`. Cost: see `fit_arm`.
void name_by_least_squares(DiagnosisWork& work);

} // namespace dfdyn::tools
