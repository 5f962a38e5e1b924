// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/axis.hpp"

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Elements of the charts.
namespace dfdyn::tools::svg {

constexpr double plot_width = 520;
constexpr double curve_height = 330;
constexpr double top = 34;
constexpr double axis_height = 46;
constexpr double value_axis_width = 66;
constexpr double letter_width = 7.4; ///< of the chart's font, with a margin
constexpr double legend_line = 34;
constexpr double legend_height = 20;

/// Formats with one decimal: a tenth of a pixel.
std::string number(double value);

/// Formats a point with two decimals, for paths that a page may enlarge.
std::string fine_point(std::string_view command, double x, double y);

/// Concatenates the parts. (GCC 12 warns falsely about a literal + a string.)
std::string joined(std::initializer_list<std::string_view> parts);

std::string attribute(std::string_view name, double value);
std::string line(std::string_view kind, double x1, double y1, double x2, double y2);

/// Returns a text element. `content`: already escaped.
std::string text(std::string_view kind, double x, double y, std::string_view content);

/// Returns the beginning of a chart with its title, which is plain text.
std::string opening(const std::string& title, double width, double height);

/// Returns colour and, beyond the first four, dashes; `index`: number of the curve or box in a chart.
std::string appearance(std::size_t index);

/// Number of characters, not bytes.
std::size_t length_of(const std::string& utf8);

template <class Named>
double width_of_names(const std::vector<Named>& named) {
    std::size_t longest = 0;
    for (const Named& one : named) {
        longest = std::max(longest, length_of(one.name));
    }
    return letter_width * static_cast<double>(longest);
}

std::string x_label(double middle, double y_bottom, const std::string& label);
std::string y_label(double middle, const std::string& label);

/// Returns lines and labels of a horizontal axis, at `ticks_of(x)`.
template <class Axis>
std::string vertical_grid(const Axis& x, double y_top, double y_bottom, const std::string& label) {
    std::string all;
    for (const AxisTick& tick : ticks_of(x)) {
        const double at = x.pixel(tick.value);
        all += line(tick.label.empty() ? "grid minor" : "grid", at, y_top, at, y_bottom);
        all += tick.label.empty() ? "" : text("tick", at, y_bottom + 17, tick.label);
    }
    return all + x_label((x.low_pixel + x.high_pixel) / 2, y_bottom, label);
}

/// Returns lines and labels of a vertical axis.
template <class Axis>
std::string horizontal_grid(const Axis& y, double x_left, double x_right, const std::string& label) {
    std::string all;
    for (const AxisTick& tick : ticks_of(y)) {
        const double at = y.pixel(tick.value);
        all += line(tick.label.empty() ? "grid minor" : "grid", x_left, at, x_right, at);
        all += tick.label.empty() ? "" : text("tick y", x_left - 7, at + 4, tick.label);
    }
    return all + y_label((y.low_pixel + y.high_pixel) / 2, label);
}

/// Returns the ends of an axis, without loss.
std::string ends_of(double low, double high);

/// Returns the grid, ticks and labels of both axes of a plot, with the ends of the axes for the zoom of a
/// page.
template <class Axis>
std::string axes(const Axis& x, const Axis& y, const std::string& x_label, const std::string& y_label) {
    return joined({"<g class=\"axes\" data-scale=\"", std::is_same_v<Axis, LogAxis> ? "log" : "linear",
                   "\" data-x=\"", ends_of(x.low, x.high), "\" data-y=\"", ends_of(y.low, y.high), "\">\n",
                   vertical_grid(x, y.high_pixel, y.low_pixel, x_label),
                   horizontal_grid(y, x.low_pixel, x.high_pixel, y_label), "</g>\n"});
}

/// Returns marks of a plot. Its coordinates are those of the chart until the page shows a part of it.
template <class Axis>
std::string plotted(const Axis& x, const Axis& y, std::string_view marks) {
    const double width = x.high_pixel - x.low_pixel;
    const double height = y.low_pixel - y.high_pixel;
    return joined({"<svg class=\"plot\" preserveAspectRatio=\"none\"", attribute("x", x.low_pixel),
                   attribute("y", y.high_pixel), attribute("width", width), attribute("height", height),
                   " viewBox=\"", number(x.low_pixel), " ", number(y.high_pixel), " ", number(width), " ",
                   number(height), "\">\n", marks, "</svg>\n"});
}

} // namespace dfdyn::tools::svg
