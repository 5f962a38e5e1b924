// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Returns whether the gears of an arm are real ones: at half of the joints that move, and at two at least,
/// no effect is exactly right.
bool friction_everywhere(const DiagnosisWork& work);

/// Returns the probability that a value with a standard deviation is known to its half.
double probability_of_size(double value, double deviation);

/// Names what least squares finds on the whole recording: at each joint where plain least squares is the
/// extended model (`fit_moving_rows`), or, where half of the joints have real gears, at every joint
/// (`fit_arm`). Its friction, rotor inertia and offset become the findings there. What else was found at the
/// joint or its actuator gets a confidence below 0.5, except contacts, and a gain that the fit shows, too.
/// Joints that hardly move, or for less than ten blocks of time, keep their findings. Sets `textbook` of the
/// diagnosis and `extended`. Cost: that of `fit_arm`.
void name_by_least_squares(DiagnosisWork& work);

} // namespace dfdyn::tools
