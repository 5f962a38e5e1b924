// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

#include <string>

namespace dfdyn::tools {

/// Schema `dfdyn.diagnosis/1`.
std::string diagnosis_to_json(const Diagnosis& diagnosis);

} // namespace dfdyn::tools
