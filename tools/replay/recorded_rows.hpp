// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/replay/replay.hpp"

#include <cstddef>
#include <span>

namespace dfdyn::tools {

/// Runs `estimator` over the rows from `first` to `last` (not included), counted over all recordings. Calls
/// `use(sample, tick, begins)` after each. `begins`: the row does not follow the one before.
template <class Use>
void tick_rows(RuntimeEstimator& estimator, std::span<const Recording> recordings, std::size_t first,
               std::size_t last, Budget budget, Use use) {
    std::size_t count = 0;
    bool begins = true;
    for (const Recording& recording : recordings) {
        for (std::size_t row = 0; row < recording.row_count(); ++row, ++count) {
            if (count < first || count >= last) {
                continue;
            }
            begins = begins || recording.gap_before[row] != 0;
            if (begins) {
                estimator.begin_recording();
            }
            const MeasuredSample sample = sample_at(recording, row);
            use(sample, estimator.tick(sample, budget), begins);
            begins = false;
        }
    }
}

} // namespace dfdyn::tools
