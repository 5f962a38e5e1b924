// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/report/figure_page.hpp"

namespace dfdyn::tools {

/// A finding with its evidence: the error without this effect over what explains it, parameters with their
/// intervals, what else was considered, what would settle it. `number`: from 1.
PageSection finding_section(const DiagnosisWork& work, const Finding& finding, std::size_t number);

} // namespace dfdyn::tools
