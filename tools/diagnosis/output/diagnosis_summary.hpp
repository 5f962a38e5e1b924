// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/extension/extension.hpp"

#include <ostream>
#include <vector>

namespace dfdyn::tools {

/// Prints a diagnosis on a terminal, in one screen: first why the recording may be unsuitable, then the
/// errors per output, the findings, the unexplained rest, and what the extended model lacks.
void print_diagnosis(std::ostream& out, const Diagnosis& diagnosis,
                     const std::vector<ExtendedFinding>& carried);

} // namespace dfdyn::tools
