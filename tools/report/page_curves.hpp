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
    bool thinned = false;            ///< `report` has a part of the ticks only
};

/// Returns the report with at most `most_report_ticks` ticks. Of longer reports it keeps the extremes of each
/// output and its error and the largest innovation in intervals of equal length, and the ticks at gaps. Gaps,
/// searched in all ticks, are the start of a recording and a time step of more than ten times the median.
/// Cost: ticks times series.
PageCurves page_curves(const Report& report);

} // namespace dfdyn::tools
