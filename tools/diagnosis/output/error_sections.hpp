// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/report/figure_page.hpp"

namespace dfdyn::tools {

/// Measured, simulated and extended over a stretch of time, and the errors of both models, per output.
PageSection comparison_section(const DiagnosisWork& work);

/// Spectra of the errors, how white what is left is, and what it still depends on.
PageSection rest_section(const DiagnosisWork& work);

} // namespace dfdyn::tools
