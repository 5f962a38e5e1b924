// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dfdyn::tools {

/// A grid line of an axis, with an optional label.
struct AxisTick {
    double value;
    std::string label; ///< SVG text; empty: a line only
};

} // namespace dfdyn::tools
