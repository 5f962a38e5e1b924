// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <string>

namespace dfdyn::tools {

/// Returns the model as a C++ header of constants for flash memory: `NAME::Model`, `NAME::constants` and the
/// initial state to which they point, with `name_space` for NAME. The header needs the firmware library only.
/// Its numbers equal those of `model_to_json`, bit for bit in single precision.
std::string model_to_header(const TrainedModel& model, const std::string& name_space);

/// Converts a file's stem to a C++ identifier: `my-arm 2` becomes `my_arm_2`, `2dof` becomes `model_2dof`,
/// and the keyword `class` becomes `class_`.
std::string to_identifier(const std::string& stem);

} // namespace dfdyn::tools
