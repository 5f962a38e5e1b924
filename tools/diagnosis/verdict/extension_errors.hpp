// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Errors from row `first` on (below the number of rows), without the causes of an explanation and with them:
/// `nominal`, `extended` and `standing_share` of the diagnosis.
void measure_from(DiagnosisWork& work, Eigen::Index first, const Explanation& explanation);

/// Errors on the last third, of a model that is chosen and fitted without it; and a suspicion where they are
/// larger with the causes than without. Cost: that of a diagnosis.
void measure_on_held_out(DiagnosisWork& work, ExplanationOptions options);

} // namespace dfdyn::tools
