// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dfdyn::tools {

/// What is wrong, in words for whoever stands in front of the robot.
struct BusFinding {
    std::string rule; ///< its name, stable
    std::string what;
    std::string evidence; ///< what it was inferred from
    std::string confirm;  ///< the check that would confirm it
    std::string fix;
};

} // namespace dfdyn::tools
