// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace dfdyn::tools {

/// A line and a band with the same x. Points that are not positive and finite interrupt both.
struct ChartCurve {
    std::string name;
    std::vector<double> x, y;
    std::vector<double> low, high;
};

/// A box with whiskers, and a dot for the mean. Not drawn unless the median is positive and finite.
struct ChartBox {
    std::string name;
    double low, lower_quartile, median, upper_quartile, high, mean;
};

/// Returns the curves over two logarithmic axes, with a legend at the side, as one <svg> element with the
/// colours of the chart style. The n-th curve has the colour of the n-th box. All texts are plain UTF-8.
std::string curve_chart(const std::string& title, const std::string& x_label, const std::string& y_label,
                        const std::vector<ChartCurve>& curves);

/// Returns the boxes below each other over one logarithmic axis, as one <svg> element.
std::string box_chart(const std::string& title, const std::string& x_label,
                      const std::vector<ChartBox>& boxes);

/// Returns the chart as a separate file, including its style, in light colours on white for any theme of the
/// reader.
std::string standalone_chart(const std::string& svg);

} // namespace dfdyn::tools
