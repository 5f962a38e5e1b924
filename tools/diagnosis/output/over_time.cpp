// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/over_time.hpp"

#include "tools/base/text/instant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

TimeAxis time_axis(const MeasuredMotion& measured) {
    const double first_s = measured.time_s.size() > 0 ? measured.time_s[0] : 0;
    if (!is_epoch_time(first_s)) {
        return {0, "time (s)"};
    }
    return {std::floor(first_s), "time after " + instant_text(std::floor(first_s)) + " (s)"};
}

XyLine line_over_time(const MeasuredMotion& measured, std::string name, const Eigen::VectorXd& series,
                      const std::vector<Eigen::Index>& rows) {
    const double origin_s = time_axis(measured).origin_s;
    const auto stretch_of = [&](Eigen::Index row) {
        return std::ranges::upper_bound(measured.stretches, row, {}, &Stretch::first);
    };
    XyLine line{std::move(name), {}, {}};
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const double time_s = measured.time_s[rows[i]] - origin_s;
        if (i > 0 && stretch_of(rows[i]) != stretch_of(rows[i - 1])) {
            line.x.push_back(time_s);
            line.y.push_back(std::numeric_limits<double>::quiet_NaN());
        }
        line.x.push_back(time_s);
        line.y.push_back(series[rows[i]]);
    }
    return line;
}

} // namespace dfdyn::tools
