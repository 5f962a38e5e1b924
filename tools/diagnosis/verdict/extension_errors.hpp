// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Measures the errors of the samples from row `first` on (less than the number of rows): without and with
/// the fitted effects, and of plain least squares, fitted before that row (0: on all rows). Sets `nominal`,
/// `causes`, `extended`, `least_squares`, `by_least_squares` and `standstill_share` of the diagnosis. Where
/// the error with the effects is 3 % larger than that of plain least squares, `extended` has the latter. If
/// `work.samples` has no rows, sets it to the samples of `work.measured`.
void measure_from(DiagnosisWork& work, Eigen::Index first, const FittedEffects& fitted_effects);

/// Measures the errors on the last third, for a model that is chosen and fitted on the first two thirds. Adds
/// a suspicion if the effects increase the errors. Cost: one more diagnosis.
void measure_on_held_out(DiagnosisWork& work, FitOptions options);

} // namespace dfdyn::tools
