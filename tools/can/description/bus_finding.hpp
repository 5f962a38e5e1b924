// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dfdyn::tools {

/// A fault of the bus or a device, described for the person at the robot.
struct BusFinding {
    std::string rule; ///< stable name of the rule
    std::string what;
    std::string evidence; ///< observation from which the fault was inferred
    std::string confirm;  ///< a check that would confirm it
    std::string fix;      ///< steps of the remedy, one short imperative sentence each
};

} // namespace dfdyn::tools
