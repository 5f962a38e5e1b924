// SPDX-License-Identifier: Apache-2.0
#include "tools/report/chart.hpp"

#include "tools/report/log_axis.hpp"
#include "tools/report/page_text.hpp"
#include "tools/report/report_assets.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <string_view>

namespace dfdyn::tools {

namespace {

constexpr double plot_width = 520;
constexpr double curve_height = 330;
constexpr double top = 34;
constexpr double axis_height = 46;
constexpr double value_axis_width = 66;
constexpr double row_height = 26;
constexpr double box_height = 14;
constexpr double letter_width = 7.4; ///< of the chart's font, on the safe side
constexpr double legend_line = 34;
constexpr int colours = 8;

std::string number(double value) {
    std::array<char, 32> text{};
    return {text.data(),
            std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 1).ptr};
}

/// The parts behind each other. (GCC 12 warns falsely about a literal + a string.)
std::string joined(std::initializer_list<std::string_view> parts) {
    std::string all;
    for (const std::string_view part : parts) {
        all += part;
    }
    return all;
}

std::string attribute(std::string_view name, double value) {
    return joined({" ", name, "=\"", number(value), "\""});
}

std::string line(std::string_view kind, double x1, double y1, double x2, double y2) {
    return joined({"<line class=\"", kind, "\"", attribute("x1", x1), attribute("y1", y1),
                   attribute("x2", x2), attribute("y2", y2), "/>\n"});
}

/// `svg`: the content, escaped already.
std::string text(std::string_view kind, double x, double y, std::string_view svg) {
    return joined(
        {"<text class=\"", kind, "\"", attribute("x", x), attribute("y", y), ">", svg, "</text>\n"});
}

/// Letters, not bytes.
std::size_t length_of(const std::string& utf8) {
    return static_cast<std::size_t>(
        std::ranges::count_if(utf8, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

template <class Named>
double width_of_names(const std::vector<Named>& named) {
    std::size_t longest = 0;
    for (const Named& one : named) {
        longest = std::max(longest, length_of(one.name));
    }
    return letter_width * static_cast<double>(longest);
}

std::string opening(const std::string& title, double width, double height) {
    return joined({R"(<svg xmlns="http://www.w3.org/2000/svg" class="chart" role="img" viewBox="0 0 )",
                   number(width), " ", number(height), "\"", attribute("width", width),
                   attribute("height", height), " aria-label=\"", escape_html(title), "\">\n",
                   text("title", 6, 16, escape_html(title))});
}

/// Colour and, beyond the first four, dashes: `index` counts the curves or boxes of a chart.
std::string appearance(std::size_t index) {
    return joined({"c", std::to_string(index % colours), " dash", std::to_string(index / 4 % 3)});
}

bool drawable(double value) { return std::isfinite(value) && value > 0; }

std::string point(std::string_view command, const LogAxis& x, const LogAxis& y, double x_value,
                  double y_value) {
    return joined({command, number(x.pixel(x_value)), " ", number(y.pixel(y_value))});
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

/// The band of points first … last - 1: forth along the upper edge, back along the lower.
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
    const double legend_y = top + 10 + 20 * static_cast<double>(index);
    const std::string name = escape_html(curve.name);
    return joined({"<g class=\"curve ", appearance(index), "\"><title>", name, "</title>\n",
                   "<path class=\"band\" d=\"", band_path(curve, x, y), "\"/>\n", "<path class=\"line\" d=\"",
                   line_path(curve, x, y), "\"/>\n",
                   line("line", legend_x, legend_y, legend_x + legend_line - 8, legend_y),
                   text("name", legend_x + legend_line, legend_y + 4, name), "</g>\n"});
}

std::string vertical_grid(const LogAxis& x, double y_top, double y_bottom, const std::string& label) {
    std::string svg;
    for (const LogTick& tick : ticks_of(x)) {
        svg += line(tick.label.empty() ? "grid minor" : "grid", x.pixel(tick.value), y_top,
                    x.pixel(tick.value), y_bottom);
        svg += tick.label.empty() ? "" : text("tick", x.pixel(tick.value), y_bottom + 17, tick.label);
    }
    return svg + text("label", (x.low_pixel + x.high_pixel) / 2, y_bottom + 38, escape_html(label));
}

std::string horizontal_grid(const LogAxis& y, double x_left, double x_right, const std::string& label) {
    std::string svg;
    for (const LogTick& tick : ticks_of(y)) {
        svg += line(tick.label.empty() ? "grid minor" : "grid", x_left, y.pixel(tick.value), x_right,
                    y.pixel(tick.value));
        svg += tick.label.empty() ? "" : text("tick y", x_left - 7, y.pixel(tick.value) + 4, tick.label);
    }
    const double middle = (y.low_pixel + y.high_pixel) / 2;
    return joined({svg, "<text class=\"label\" transform=\"translate(14 ", number(middle), ") rotate(-90)\">",
                   escape_html(label), "</text>\n"});
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

/// Box, whiskers, median and mean about the height `middle`.
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
    const double legend_height = 20 * static_cast<double>(curves.size());
    const double bottom = top + std::max(curve_height, legend_height);
    const double right = value_axis_width + plot_width;
    const LogAxis x = log_axis(drawn_values(curves, true), value_axis_width, right);
    const LogAxis y = log_axis(drawn_values(curves, false), bottom, top);
    const double width = right + 14 + legend_line + width_of_names(curves);
    std::string svg = opening(title, width, bottom + axis_height) + vertical_grid(x, top, bottom, x_label) +
                      horizontal_grid(y, value_axis_width, right, y_label);
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
