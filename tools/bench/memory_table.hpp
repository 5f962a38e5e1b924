// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Memory of the firmware's estimator of model NP: six joints, six outputs, input DFR with eleven positions.
struct MemoryRow {
    std::string scalar;
    int columns;
    Footprint bytes;
};

std::vector<MemoryRow> memory_rows();

} // namespace dfdyn::tools
