// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

#include <nlohmann/json_fwd.hpp>

namespace dfdyn::tools {

/// Returns the content of diagnosis.json, schema `dfdyn.diagnosis/1`.
nlohmann::ordered_json diagnosis_json(const Diagnosis& diagnosis);

} // namespace dfdyn::tools
