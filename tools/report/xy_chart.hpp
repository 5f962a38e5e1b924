// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace dfdyn::tools {

/// A line; points that are not finite interrupt it.
struct XyLine {
    std::string name;
    std::vector<double> x, y;
};

/// Means of what lies in neighbouring bins of x, each with the spread about it.
struct XyBins {
    std::string name;
    std::vector<double> x, mean, deviation;
};

/// A cloud of dots.
struct XyPoints {
    std::string name;
    std::vector<double> x, y;
};

/// What a chart over two linear axes shows, the first below the next. Those
/// without an x are left out.
struct XyChart {
    std::string title, x_label, y_label;
    XyLine reference{}; ///< wide and grey below the others: what was measured
    XyPoints points{};
    XyBins bins{};
    std::vector<XyLine> lines{};
    double height = 330; ///< of the plot, in pixels
};

/// The chart with a legend beside it, as one <svg> element in the style of the other charts. Lines come in
/// the first colours; dots and bins are grey. All texts are plain UTF-8. Dots that are not finite are left
/// out.
std::string xy_chart(const XyChart& chart);

/// Means and deviations of `y` in `count` bins of equally many points each over x. Points that are not finite
/// are left out; bins whose x are all the same are one.
XyBins binned(std::string name, const std::vector<double>& x, const std::vector<double>& y,
              std::size_t count);

} // namespace dfdyn::tools
