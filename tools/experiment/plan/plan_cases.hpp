// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/experiment/plan/plan.hpp"

#include <vector>

namespace dfdyn::tools {

/// Returns the cases of one entry of "cases": every combination of its values of model, input, hyper and
/// rows_per_joint. Missing fields are those of `defaults`. A case is named MODEL-HYPER-INPUT, then -kN if
/// rows_per_joint is a list, then the entry's "suffix". An entry with "combine" is one case.
std::vector<Case> expand_cases(const JsonReader& entry, const Case& defaults);

/// Reads a plan's "defaults", which replace those of a Case.
Case read_defaults(const JsonReader& entry);

} // namespace dfdyn::tools
