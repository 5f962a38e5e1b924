// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <cstddef>
#include <span>

namespace dfdyn::tools {

inline std::size_t row_count(std::span<const Recording> recordings) {
    std::size_t rows = 0;
    for (const Recording& recording : recordings) {
        rows += recording.row_count();
    }
    return rows;
}

/// Calls `use(recording, row, begins)` for the rows from `first` to `last` (not included), counted over all
/// recordings. `begins`: the row does not follow the one before.
template <class Use>
void for_each_row(std::span<const Recording> recordings, std::size_t first, std::size_t last, Use use) {
    std::size_t count = 0;
    bool begins = true;
    for (const Recording& recording : recordings) {
        for (std::size_t row = 0; row < recording.row_count(); ++row, ++count) {
            if (count >= first && count < last) {
                use(recording, row, begins || recording.gap_before[row] != 0);
                begins = false;
            }
        }
    }
}

} // namespace dfdyn::tools
