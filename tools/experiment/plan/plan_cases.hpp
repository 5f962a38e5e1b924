// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/experiment/plan/plan.hpp"

#include <vector>

namespace dfdyn::tools {

/// The cases of one entry of "cases": every combination of what it lists under model, input, hyper and
/// rows_per_joint. What the entry does not say is as in `defaults`. A case is named MODEL-HYPER-INPUT, then
/// -kN where rows_per_joint is a list, then the entry's "suffix". An entry with "combine" is one case.
std::vector<Case> expand_cases(const JsonReader& entry, const Case& defaults);

/// The fields of a plan's "defaults", over those of a Case.
Case read_defaults(const JsonReader& entry);

} // namespace dfdyn::tools
