// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/report/figure_page.hpp"

namespace dfdyn::tools {

/// Measured, simulated and extended outputs over a time window, and the errors of both models, per output.
PageSection comparison_section(const DiagnosisWork& work);

/// Spectra of the errors, whiteness of the residual, and its remaining dependences.
PageSection rest_section(const DiagnosisWork& work);

} // namespace dfdyn::tools
