// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/row_parts.hpp"

#include <algorithm>

namespace dfdyn::tools {
namespace {

void cut(Columns& columns, std::size_t first, std::size_t last) {
    const auto width = static_cast<std::ptrdiff_t>(columns.names.size());
    const auto begin = columns.values.begin();
    columns.values = {begin + width * static_cast<std::ptrdiff_t>(first),
                      begin + width * static_cast<std::ptrdiff_t>(last)};
}

} // namespace

Recording rows_between(Recording recording, std::size_t first, std::size_t last) {
    const auto cut_rows = [&](auto& values) {
        values = {values.begin() + static_cast<std::ptrdiff_t>(first),
                  values.begin() + static_cast<std::ptrdiff_t>(last)};
    };
    cut_rows(recording.time_s);
    cut_rows(recording.time_ns);
    cut_rows(recording.gap_before);
    for (Columns* const columns :
         {&recording.position, &recording.velocity, &recording.acceleration, &recording.output}) {
        cut(*columns, first, last);
    }
    recording.gap_before.front() = 1;
    return recording;
}

SplitRecordings split_recordings(std::span<const Recording> recordings, double share) {
    auto left = static_cast<std::size_t>(share * static_cast<double>(total_rows(recordings)));
    SplitRecordings split;
    for (const Recording& recording : recordings) {
        const std::size_t rows = recording.row_count();
        const std::size_t first = std::min(left, rows);
        left -= first;
        if (first > 0) {
            split.training.push_back(rows_between(recording, 0, first));
        }
        if (first < rows) {
            split.judging.push_back(rows_between(recording, first, rows));
        }
    }
    return split;
}

} // namespace dfdyn::tools
