// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/report/figure_page.hpp"

namespace dfdyn::tools {

/// A finding and its evidence: the error without this effect over the explaining variable, parameters with
/// their intervals, alternatives, and an experiment that would confirm it. `number`: from 1.
PageSection finding_section(const DiagnosisWork& work, const Finding& finding, std::size_t number);

} // namespace dfdyn::tools
