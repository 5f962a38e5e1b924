// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/extension/extension.hpp"

#include <ostream>
#include <vector>

namespace dfdyn::tools {

/// A diagnosis on a terminal, in one screenful: what makes the recording suspect first, then the errors per
/// output, the findings, what is left, and what the extended model does not have.
void print_diagnosis(std::ostream& out, const Diagnosis& diagnosis,
                     const std::vector<CarriedFinding>& carried);

} // namespace dfdyn::tools
