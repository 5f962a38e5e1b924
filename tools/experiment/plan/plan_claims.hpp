// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/experiment/plan/plan.hpp"

namespace dfdyn::tools {

/// Reads "figures", "comparisons" and "findings" into `plan`, which already has its cases and groups. Without
/// "figures", adds one with all cases.
void read_claims(const JsonReader& json, Plan& plan);

} // namespace dfdyn::tools
