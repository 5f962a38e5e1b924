// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/measured_motion.hpp"
#include "tools/report/xy_chart.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Time axis of a chart. Times from 1970 are counted from the first full second of the recording, and the
/// label contains its date.
struct TimeAxis {
    double origin_s = 0;
    std::string label;
};

TimeAxis time_axis(const MeasuredMotion& measured);

/// Returns `series` (T) at `rows` (ascending) over the time axis, interrupted where a stretch ends.
XyLine line_over_time(const MeasuredMotion& measured, std::string name, const Eigen::VectorXd& series,
                      const std::vector<Eigen::Index>& rows);

} // namespace dfdyn::tools
