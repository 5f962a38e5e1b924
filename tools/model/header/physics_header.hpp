// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <string>

namespace dfdyn::tools {

/// The C++ type of a model's physics, and its constants.
std::string physics_type(const PhysicsModel& physics);
std::string physics_constants(const PhysicsModel& physics);

} // namespace dfdyn::tools
