// SPDX-License-Identifier: Apache-2.0
#include "tools/report/chart.hpp"

#include "tools/report/axis.hpp"
#include "tools/report/chart_svg.hpp"
#include "tools/report/page_text.hpp"
#include "tools/report/report_assets.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace dfdyn::tools {

namespace {

using namespace svg;

constexpr double row_height = 26;
constexpr double box_height = 14;

bool drawable(double value) { return std::isfinite(value) && value > 0; }

std::string point(std::string_view command, const LogAxis& x, const LogAxis& y, double x_value,
                  double y_value) {
    return fine_point(command, x.pixel(x_value), y.pixel(y_value));
}

bool drawable_at(const ChartCurve& curve, std::size_t i) {
    return drawable(curve.x[i]) && drawable(curve.y[i]) && drawable(curve.low[i]) && drawable(curve.high[i]);
}

std::string line_path(const ChartCurve& curve, const LogAxis& x, const LogAxis& y) {
    std::string path;
    bool open = false;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        const bool drawn = drawable_at(curve, i);
        if (drawn) {
            path += point(open ? "L" : "M", x, y, curve.x[i], curve.y[i]);
        }
        open = drawn;
    }
    return path;
}

/// Band of the points first … last - 1: forward along the upper edge, back along the lower edge.
std::string band_stretch(const ChartCurve& curve, std::size_t first, std::size_t last, const LogAxis& x,
                         const LogAxis& y) {
    std::string path;
    for (std::size_t i = first; i < last; ++i) {
        path += point(i == first ? "M" : "L", x, y, curve.x[i], curve.high[i]);
    }
    for (std::size_t i = last; i > first; --i) {
        path += point("L", x, y, curve.x[i - 1], curve.low[i - 1]);
    }
    return path + "Z";
}

std::string band_path(const ChartCurve& curve, const LogAxis& x, const LogAxis& y) {
    std::string path;
    for (std::size_t first = 0; first < curve.x.size(); ++first) {
        std::size_t last = first;
        while (last < curve.x.size() && drawable_at(curve, last)) {
            ++last;
        }
        if (last > first) {
            path += band_stretch(curve, first, last, x, y);
            first = last;
        }
    }
    return path;
}

std::string curve_svg(const ChartCurve& curve, std::size_t index, const LogAxis& x, const LogAxis& y,
                      double legend_x) {
    const double legend_y = top + 10 + legend_height * static_cast<double>(index);
    const std::string name = escape_html(curve.name);
    const std::string marks = joined({"<path class=\"band\" d=\"", band_path(curve, x, y),
                                      "\"/>\n<path class=\"line\" d=\"", line_path(curve, x, y), "\"/>\n"});
    return joined({"<g class=\"curve ", appearance(index), "\"><title>", name, "</title>\n",
                   plotted(x, y, marks),
                   line("line", legend_x, legend_y, legend_x + legend_line - 8, legend_y),
                   text("name", legend_x + legend_line, legend_y + 4, name), "</g>\n"});
}

std::vector<double> drawn_values(const std::vector<ChartCurve>& curves, bool of_x) {
    std::vector<double> values;
    for (const ChartCurve& curve : curves) {
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            if (drawable_at(curve, i)) {
                values.insert(values.end(),
                              {of_x ? curve.x[i] : curve.low[i], of_x ? curve.x[i] : curve.high[i]});
            }
        }
    }
    return values;
}

/// Box, whiskers, median and mean at the height `middle`.
std::string box_marks(const ChartBox& box, const LogAxis& x, double middle) {
    const double left = x.pixel(box.lower_quartile);
    const double width = std::max(x.pixel(box.upper_quartile) - left, 0.5);
    const double above = middle - box_height / 2;
    return joined(
        {line("whisker", x.pixel(box.low), middle, x.pixel(box.high), middle), "<rect", attribute("x", left),
         attribute("y", above), attribute("width", width), attribute("height", box_height), "/>\n",
         line("median", x.pixel(box.median), above, x.pixel(box.median), above + box_height), "<circle",
         attribute("cx", x.pixel(box.mean)), attribute("cy", middle), attribute("r", 2.6), "/>\n"});
}

std::string box_svg(const ChartBox& box, std::size_t index, const LogAxis& x, double name_width) {
    const double middle = top + row_height * (static_cast<double>(index) + 0.5);
    const std::string name = escape_html(box.name);
    return joined({"<g class=\"box ", appearance(index), "\"><title>", name, "</title>\n",
                   text("name end", name_width, middle + 4, name),
                   drawable(box.median) ? box_marks(box, x, middle) : "", "</g>\n"});
}

} // namespace

std::string curve_chart(const std::string& title, const std::string& x_label, const std::string& y_label,
                        const std::vector<ChartCurve>& curves) {
    const double legend = legend_height * static_cast<double>(curves.size());
    const double bottom = top + std::max(curve_height, legend);
    const double right = value_axis_width + plot_width;
    const LogAxis x = log_axis(drawn_values(curves, true), value_axis_width, right);
    const LogAxis y = log_axis(drawn_values(curves, false), bottom, top);
    const double width = right + 14 + legend_line + width_of_names(curves);
    std::string svg = opening(title, width, bottom + axis_height) + axes(x, y, x_label, y_label);
    for (std::size_t i = 0; i < curves.size(); ++i) {
        svg += curve_svg(curves[i], i, x, y, right + 14);
    }
    return svg + "</svg>\n";
}

std::string box_chart(const std::string& title, const std::string& x_label,
                      const std::vector<ChartBox>& boxes) {
    const double name_width = width_of_names(boxes);
    const double left = name_width + 12;
    const double bottom = top + row_height * static_cast<double>(boxes.size());
    std::vector<double> values;
    for (const ChartBox& box : boxes) {
        values.insert(values.end(), {box.low, box.high, box.mean});
    }
    const LogAxis x = log_axis(values, left, left + plot_width);
    std::string svg =
        opening(title, left + plot_width + 26, bottom + axis_height) + vertical_grid(x, top, bottom, x_label);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        svg += box_svg(boxes[i], i, x, name_width);
    }
    return svg + "</svg>\n";
}

std::string standalone_chart(const std::string& svg) {
    const std::size_t after_tag = svg.find('>') + 1;
    const std::string_view whole = svg;
    return joined({whole.substr(0, after_tag), "\n<style>\n", assets::chart_css,
                   "</style>\n<rect class=\"paper\" width=\"100%\" height=\"100%\"/>",
                   whole.substr(after_tag)});
}

} // namespace dfdyn::tools
