// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension/joined_recording.hpp"

#include <algorithm>
#include <optional>

namespace dfdyn::tools {

namespace {

constexpr auto pause_ns = static_cast<std::int64_t>(1e9 * joined_pause_s);

void append(Columns& columns, const Columns& more) {
    columns.values.insert(columns.values.end(), more.values.begin(), more.values.end());
}

} // namespace

Recording joined_recording(std::span<const Recording> recordings) {
    Recording joined = recordings.front();
    for (const Recording& next : recordings.subspan(1)) {
        if (next.row_count() == 0) {
            continue;
        }
        const std::int64_t shift_ns =
            joined.row_count() == 0 ? 0 : joined.time_ns.back() + pause_ns - next.time_ns.front();
        for (std::size_t row = 0; row < next.row_count(); ++row) {
            joined.time_ns.push_back(next.time_ns[row] + shift_ns);
            joined.time_s.push_back(1e-9 * static_cast<double>(joined.time_ns.back()));
        }
        append(joined.position, next.position);
        append(joined.velocity, next.velocity);
        append(joined.acceleration, next.acceleration);
        append(joined.output, next.output);
        joined.gap_before.insert(joined.gap_before.end(), next.gap_before.begin(), next.gap_before.end());
        joined.source.append(", ").append(next.source);
    }
    return joined;
}

std::vector<double> ends_in_joined(std::span<const Recording> recordings) {
    std::vector<double> ends;
    std::optional<double> end;
    for (const Recording& recording : recordings) {
        if (recording.row_count() > 0) {
            const double start = end ? *end + 1e-9 * pause_ns : recording.time_s.front();
            end = start + recording.time_s.back() - recording.time_s.front();
        }
        ends.push_back(end.value_or(0));
    }
    return ends;
}

} // namespace dfdyn::tools
