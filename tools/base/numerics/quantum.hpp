// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Returns the quantization step of values in any order: the smallest difference of two of them, if all
/// others are multiples of it. Empty if they are not, or for fewer than six different values. O(n log n).
std::optional<double> quantum_of(std::vector<double> values);

} // namespace dfdyn::tools
