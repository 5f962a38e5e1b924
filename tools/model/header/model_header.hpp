// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <string>

namespace dfdyn::tools {

/// The model as a C++ header of constants for flash: `NAME::Model`, `NAME::constants` and the start they
/// point to, NAME being `name_space`. Needs only the firmware library. The numbers are those of
/// `model_to_json`, bit for bit in single precision.
std::string model_to_header(const TrainedModel& model, const std::string& name_space);

/// A C++ identifier out of a file's stem: `my-arm 2` becomes `my_arm_2`, `2dof` becomes `model_2dof`.
std::string to_identifier(const std::string& stem);

} // namespace dfdyn::tools
