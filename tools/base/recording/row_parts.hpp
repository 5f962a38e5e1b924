// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Returns the rows [first, last) of a recording, `first` < `last` <= row_count(). The first one has a gap
/// before it.
Recording rows_between(Recording recording, std::size_t first, std::size_t last);

/// The first rows of recordings in order, for training, and the other ones, for evaluation.
struct SplitRecordings {
    std::vector<Recording> training, judging;
};

/// Returns the first `share` (0 to 1) of all rows and the rest.
SplitRecordings split_recordings(std::span<const Recording> recordings, double share);

} // namespace dfdyn::tools
