// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

inline constexpr double joined_pause_s = 2; ///< between the recordings of a joined one

/// Joins several recordings into one with gaps: each begins `joined_pause_s` after the last row of the
/// previous one. At least one recording is required, and all must have the same columns.
Recording joined_recording(std::span<const Recording> recordings);

/// Returns the time (s) of the last row of each recording in the joined one.
std::vector<double> ends_in_joined(std::span<const Recording> recordings);

} // namespace dfdyn::tools
