// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Returns the quantization step of a signal, sample by sample: the smallest difference of two values, if all
/// others are multiples of it. Empty if they are not, for fewer than six different values, and if nearly all
/// successive values differ by just that step, as in a motion of constant speed. O(n log n).
std::optional<double> quantum_of(const std::vector<double>& signal);

} // namespace dfdyn::tools
