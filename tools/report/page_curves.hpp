// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/report.hpp"

#include <cstddef>
#include <vector>

namespace dfdyn::tools {

/// The curves of a page.
struct PageCurves {
    Report report;                   ///< with the ticks that the page has
    std::vector<std::size_t> breaks; ///< ticks of `report` before which all curves are interrupted; ascending
    double sample_time_s = 1;        ///< median of all ticks, also of those that the page does not have
};

/// Returns the report with at most `most_report_ticks` ticks: of more, those with the extremes of each output
/// and of its error in stretches of equal length, and those at gaps. A gap is where a recording begins and
/// where the time between two ticks exceeds ten times the median; gaps are searched in all ticks. Cost:
/// ticks times series.
PageCurves page_curves(const Report& report);

} // namespace dfdyn::tools
