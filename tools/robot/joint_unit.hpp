// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dfdyn::tools {

/// Returns the unit at a joint of a quantity whose unit at a revolute joint is `unit`: N·m becomes N at a
/// prismatic joint, rad becomes m, kg·m² becomes kg.
std::string unit_at_joint(const std::string& unit, bool prismatic);

} // namespace dfdyn::tools
