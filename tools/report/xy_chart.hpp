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

/// Means of the values in neighbouring bins of x, each with its spread.
struct XyBins {
    std::string name;
    std::vector<double> x, mean, deviation;
};

/// A set of dots.
struct XyPoints {
    std::string name;
    std::vector<double> x, y;
};

/// Content of a chart over two linear axes, each layer above the previous one. Layers without an x are left
/// out.
struct XyChart {
    std::string title, x_label, y_label;
    XyLine reference{}; ///< wide and grey below the others, for the measurement
    XyPoints points{};
    XyBins bins{};
    std::vector<XyLine> lines{};
    double height = 330; ///< of the plot, in pixels
};

/// Returns the chart with a legend at the side, as one <svg> element in the style of the other charts. Lines
/// have the first colours; dots and bins are grey. All texts are plain UTF-8. Dots that are not finite are
/// left out.
std::string xy_chart(const XyChart& chart);

/// Returns means and standard deviations of `y` in `count` bins over x with equally many points each. Points
/// that are not finite are left out; bins with identical x are merged.
XyBins binned(std::string name, const std::vector<double>& x, const std::vector<double>& y,
              std::size_t count);

} // namespace dfdyn::tools
