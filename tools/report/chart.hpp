// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace dfdyn::tools {

/// A line with a band about it, over the same x. Points that are not positive and finite interrupt both.
struct ChartCurve {
    std::string name;
    std::vector<double> x, y;
    std::vector<double> low, high;
};

/// A box with whiskers, and a dot for the mean. Nothing is drawn where the median is not positive and finite.
struct ChartBox {
    std::string name;
    double low, lower_quartile, median, upper_quartile, high, mean;
};

/// The curves over two logarithmic axes, with a legend beside them, as one <svg> element; its colours are
/// those of the chart style. The n-th curve has the colour of the n-th box. All texts are plain UTF-8.
std::string curve_chart(const std::string& title, const std::string& x_label, const std::string& y_label,
                        const std::vector<ChartCurve>& curves);

/// The boxes below each other over one logarithmic axis, likewise.
std::string box_chart(const std::string& title, const std::string& x_label,
                      const std::vector<ChartBox>& boxes);

/// The chart as a file of its own: with its style, in light colours on white, whatever the reader's theme.
std::string standalone_chart(const std::string& svg);

} // namespace dfdyn::tools
