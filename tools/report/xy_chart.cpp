// SPDX-License-Identifier: Apache-2.0
#include "tools/report/xy_chart.hpp"

#include "tools/report/axis.hpp"
#include "tools/report/chart_svg.hpp"
#include "tools/report/page_text.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

using namespace svg;

bool finite(double x, double y) { return std::isfinite(x) && std::isfinite(y); }

std::string at(std::string_view command, const LinearAxis& x, const LinearAxis& y, double x_value,
               double y_value) {
    return fine_point(command, x.pixel(x_value), y.pixel(y_value));
}

/// Each dot is a line of length zero with round caps.
std::string dots(const XyPoints& points, const LinearAxis& x, const LinearAxis& y) {
    std::string path;
    for (std::size_t i = 0; i < points.x.size(); ++i) {
        if (finite(points.x[i], points.y[i])) {
            path += at("M", x, y, points.x[i], points.y[i]) + "h0";
        }
    }
    return joined({"<path class=\"dots\" d=\"", path, "\"/>\n"});
}

/// A line of length zero with round caps.
std::string mean_mark(double x, double y) {
    return joined({"<path class=\"mean\" d=\"", fine_point("M", x, y), "h0\"/>\n"});
}

std::string bin_marks(const XyBins& bins, const LinearAxis& x, const LinearAxis& y) {
    std::string marks;
    for (std::size_t i = 0; i < bins.x.size(); ++i) {
        const double centre = x.pixel(bins.x[i]);
        marks += line("spread", centre, y.pixel(bins.mean[i] - bins.deviation[i]), centre,
                      y.pixel(bins.mean[i] + bins.deviation[i]));
        marks += mean_mark(centre, y.pixel(bins.mean[i]));
    }
    return marks;
}

std::string path_of(const XyLine& curve, const LinearAxis& x, const LinearAxis& y) {
    std::string path;
    bool open = false;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        const bool drawn = finite(curve.x[i], curve.y[i]);
        if (drawn) {
            path += at(open ? "L" : "M", x, y, curve.x[i], curve.y[i]);
        }
        open = drawn;
    }
    return joined({"<path class=\"line\" d=\"", path, "\"/>\n"});
}

std::vector<double> all_x(const XyChart& chart) {
    std::vector<double> values = chart.points.x;
    values.insert(values.end(), chart.reference.x.begin(), chart.reference.x.end());
    values.insert(values.end(), chart.bins.x.begin(), chart.bins.x.end());
    for (const XyLine& one : chart.lines) {
        values.insert(values.end(), one.x.begin(), one.x.end());
    }
    return values;
}

std::vector<double> all_y(const XyChart& chart) {
    std::vector<double> values = chart.points.y;
    values.insert(values.end(), chart.reference.y.begin(), chart.reference.y.end());
    for (std::size_t i = 0; i < chart.bins.x.size(); ++i) {
        values.push_back(chart.bins.mean[i] - chart.bins.deviation[i]);
        values.push_back(chart.bins.mean[i] + chart.bins.deviation[i]);
    }
    for (const XyLine& one : chart.lines) {
        values.insert(values.end(), one.y.begin(), one.y.end());
    }
    return values;
}

/// One element of the chart: its marks, and those in the legend.
struct Layer {
    std::string name, look, marks;
    bool is_line = false;
};

std::string layer_svg(const Layer& layer, std::size_t index, double legend_x) {
    const double y = top + 10 + legend_height * static_cast<double>(index);
    const double middle = legend_x + (legend_line - 8) / 2;
    const std::string name = escape_html(layer.name);
    const std::string sample =
        layer.is_line ? line("line", legend_x, y, legend_x + legend_line - 8, y)
        : layer.look == "cloud"
            ? joined({"<path class=\"dots\" d=\"M", number(middle), " ", number(y), "h0\"/>\n"})
            : line("spread", middle, y - 7, middle, y + 7) + mean_mark(middle, y);
    return joined({"<g class=\"", layer.look, "\"><title>", name, "</title>\n", layer.marks, sample,
                   text("name", legend_x + legend_line, y + 4, name), "</g>\n"});
}

std::vector<Layer> layers_of(const XyChart& chart, const LinearAxis& x, const LinearAxis& y) {
    std::vector<Layer> layers;
    if (!chart.reference.x.empty()) {
        layers.push_back(
            {chart.reference.name, "reference", plotted(x, y, path_of(chart.reference, x, y)), true});
    }
    if (!chart.points.x.empty()) {
        layers.push_back({chart.points.name, "cloud", plotted(x, y, dots(chart.points, x, y))});
    }
    if (!chart.bins.x.empty()) {
        layers.push_back({chart.bins.name, "bins", plotted(x, y, bin_marks(chart.bins, x, y))});
    }
    for (std::size_t i = 0; i < chart.lines.size(); ++i) {
        layers.push_back({chart.lines[i].name, joined({"curve ", appearance(i)}),
                          plotted(x, y, path_of(chart.lines[i], x, y)), true});
    }
    return layers;
}

} // namespace

std::string xy_chart(const XyChart& chart) {
    const double right = value_axis_width + plot_width;
    const double bottom = top + chart.height;
    const LinearAxis x = linear_axis(all_x(chart), value_axis_width, right);
    const LinearAxis y = linear_axis(all_y(chart), bottom, top);
    const std::vector<Layer> layers = layers_of(chart, x, y);
    const double width = right + 14 + legend_line + width_of_names(layers);
    std::string drawn =
        opening(chart.title, width, bottom + axis_height) + axes(x, y, chart.x_label, chart.y_label);
    for (std::size_t i = 0; i < layers.size(); ++i) {
        drawn += layer_svg(layers[i], i, right + 14);
    }
    return drawn + "</svg>\n";
}

XyBins binned(std::string name, const std::vector<double>& x, const std::vector<double>& y,
              std::size_t count) {
    std::vector<std::pair<double, double>> points;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (finite(x[i], y[i])) {
            points.emplace_back(x[i], y[i]);
        }
    }
    std::ranges::sort(points);
    XyBins bins{std::move(name), {}, {}, {}};
    for (std::size_t bin = 0, first = 0; bin < count && first < points.size(); ++bin) {
        std::size_t last = std::max(first + 1, (bin + 1) * points.size() / count);
        while (last < points.size() && points[last].first == points[first].first) {
            ++last;
        }
        double sum_x = 0;
        double sum = 0;
        double squares = 0;
        for (std::size_t i = first; i < last; ++i) {
            sum_x += points[i].first;
            sum += points[i].second;
        }
        const auto size = static_cast<double>(last - first);
        for (std::size_t i = first; i < last; ++i) {
            squares += (points[i].second - sum / size) * (points[i].second - sum / size);
        }
        bins.x.push_back(sum_x / size);
        bins.mean.push_back(sum / size);
        bins.deviation.push_back(std::sqrt(squares / size));
        first = last;
    }
    return bins;
}

} // namespace dfdyn::tools
