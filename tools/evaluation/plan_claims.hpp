// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/evaluation/plan.hpp"
#include "tools/model/json_reader.hpp"

namespace dfdyn::tools {

/// Reads "figures", "comparisons" and "findings" into `plan`, which has its cases and groups. Without figures
/// there is one with all cases.
void read_claims(const JsonReader& json, Plan& plan);

} // namespace dfdyn::tools
