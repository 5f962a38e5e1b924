// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <ostream>
#include <span>

namespace dfdyn::tools {

/// Prints what recordings contain: rows, duration, rate and gaps of each; then per joint the range of its
/// positions, and per output its range and standard deviation, over all recordings.
void print_overview(std::ostream& out, std::span<const Recording> recordings);

} // namespace dfdyn::tools
