// SPDX-License-Identifier: Apache-2.0
#include "tools/start/recording_overview.hpp"

#include "tools/base/recording/sample_grid.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace dfdyn::tools {

namespace {

/// Range and standard deviation of one column over recordings.
struct ColumnStatistics {
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    double deviation = 0;
};

ColumnStatistics statistics(std::span<const Recording> recordings, Columns Recording::*columns,
                            std::size_t index) {
    ColumnStatistics result;
    double count = 0;
    double mean = 0;
    double squares = 0; // Welford's recursion
    for (const Recording& recording : recordings) {
        for (std::size_t row = 0; row < recording.row_count(); ++row) {
            const double value = (recording.*columns).row(row)[index];
            result.least = std::min(result.least, value);
            result.most = std::max(result.most, value);
            count += 1;
            const double step = value - mean;
            mean += step / count;
            squares += step * (value - mean);
        }
    }
    result.deviation = std::sqrt(squares / count);
    return result;
}

void print_columns(std::ostream& out, std::span<const Recording> recordings, Columns Recording::*columns) {
    const std::vector<std::string>& names = (recordings.front().*columns).names;
    for (std::size_t index = 0; index < names.size(); ++index) {
        const ColumnStatistics found = statistics(recordings, columns, index);
        char text[120];
        std::snprintf(text, sizeof text, "  %-6s %10.4g to %-10.4g deviation %.3g\n", names[index].c_str(),
                      found.least, found.most, found.deviation);
        out << text;
    }
}

} // namespace

void print_overview(std::ostream& out, std::span<const Recording> recordings) {
    const double period_s = sample_period_s(recordings);
    for (const Recording& recording : recordings) {
        const auto gaps = std::ranges::count(window_restarts(recording, period_s), 1) - 1;
        const double duration_s = recording.time_s.back() - recording.time_s.front();
        out << shown(recording.source) << ": " << recording.row_count() << " rows, "
            << rounded_text(duration_s) << " s, " << gaps << (gaps == 1 ? " gap\n" : " gaps\n");
    }
    out << "sample rate " << formatted("%.4g", 1 / period_s) << " Hz, " << recordings.front().joint_count()
        << " joints\n";
    print_columns(out, recordings, &Recording::position);
    print_columns(out, recordings, &Recording::output);
}

} // namespace dfdyn::tools
