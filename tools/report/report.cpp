// SPDX-License-Identifier: Apache-2.0
#include "tools/report/report.hpp"

#include "tools/report/page_text.hpp"
#include "tools/report/report_assets.hpp"
#include "tools/report/report_table.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string_view>

namespace dfdyn::tools {
namespace {

using nlohmann::json;

void require(bool holds, const std::string& field, const std::string& expected) {
    if (!holds) {
        throw std::invalid_argument("report: " + field + ": " + expected);
    }
}

void require_length(std::size_t length, std::size_t expected, const std::string& field) {
    require(length == expected, field,
            "expected " + std::to_string(expected) + " values, found " + std::to_string(length));
}

std::string at(const std::string& list, std::size_t index) {
    return list + "[" + std::to_string(index) + "]";
}

void check_time(const std::vector<double>& time_s) {
    for (std::size_t i = 0; i < time_s.size(); ++i) {
        require(std::isfinite(time_s[i]), at("time_s", i), "expected a finite time");
        require(i == 0 || time_s[i] > time_s[i - 1], at("time_s", i),
                "expected a time after the one before it");
    }
}

void check_series(const Report& report) {
    const std::size_t ticks = report.time_s.size();
    for (std::size_t i = 0; i < report.series.size(); ++i) {
        const ReportSeries& series = report.series[i];
        const std::string field = at("series", i) + " (" + series.name + ").";
        require_length(series.measured.size(), ticks, field + "measured");
        require_length(series.predicted.size(), ticks, field + "predicted");
        require_length(series.standard_deviation.size(), ticks, field + "standard_deviation");
    }
}

void check_innovation(const Report& report) {
    if (!report.innovation) {
        return;
    }
    require_length(report.innovation->normalised_squared.size(), report.time_s.size(),
                   "innovation.normalised_squared");
    require(std::isfinite(report.innovation->threshold) && report.innovation->threshold > 0.0,
            "innovation.threshold", "expected a finite value above zero");
}

void check_annotations(const Report& report) {
    for (std::size_t i = 0; i < report.intervals.size(); ++i) {
        const ReportInterval& interval = report.intervals[i];
        require(std::isfinite(interval.start_s) && std::isfinite(interval.end_s) &&
                    interval.start_s <= interval.end_s,
                at("intervals", i), "expected a finite start and an end not before it");
    }
    for (std::size_t i = 0; i < report.marks.size(); ++i) {
        require(std::isfinite(report.marks[i].time_s), at("marks", i), "expected a finite time");
    }
    for (std::size_t i = 0; i < report.recordings.size(); ++i) {
        const ReportRecording& recording = report.recordings[i];
        require(std::isfinite(recording.start_s) && std::isfinite(recording.first_t_s), at("recordings", i),
                "expected finite times");
        require(i == 0 || recording.start_s > report.recordings[i - 1].start_s, at("recordings", i),
                "expected a start after the one before it");
    }
}

void check_tables(const std::vector<ReportTable>& tables) {
    for (std::size_t i = 0; i < tables.size(); ++i) {
        for (std::size_t row = 0; row < tables[i].rows.size(); ++row) {
            require_length(tables[i].rows[row].size(), tables[i].columns.size(),
                           at(at("tables", i) + ".rows", row));
        }
    }
}

json series_json(const ReportSeries& series) {
    return {{"name", series.name},
            {"unit", series.unit},
            {"measured", base64_floats(series.measured)},
            {"predicted", base64_floats(series.predicted)},
            {"standard_deviation", base64_floats(series.standard_deviation)}};
}

json innovation_json(const ReportInnovation& innovation) {
    return {{"normalised_squared", base64_floats(innovation.normalised_squared)},
            {"threshold", innovation.threshold},
            {"threshold_label", innovation.threshold_label}};
}

void add_annotations(json& data, const Report& report) {
    for (const ReportInterval& interval : report.intervals) {
        data["intervals"].push_back(
            {{"start_s", interval.start_s}, {"end_s", interval.end_s}, {"label", interval.label}});
    }
    for (const ReportMark& mark : report.marks) {
        data["marks"].push_back({{"time_s", mark.time_s}, {"label", mark.label}});
    }
    for (const ReportRecording& recording : report.recordings) {
        data["recordings"].push_back(
            {{"start_s", recording.start_s}, {"first_t_s", recording.first_t_s}, {"name", recording.name}});
    }
}

/// Adds the ticks first..last-1 at which the output or its error is extreme.
void add_extremes(const ReportSeries& series, std::size_t first, std::size_t last,
                  std::vector<std::size_t>& kept) {
    std::size_t least = first;
    std::size_t most = first;
    std::size_t worst = first;
    const auto error = [&](std::size_t tick) {
        const float value = std::abs(series.measured[tick] - series.predicted[tick]);
        return std::isfinite(value) ? value : -1.0F;
    };
    const auto below = [](float value, float other) { return value < other || std::isnan(other); };
    for (std::size_t tick = first; tick < last; ++tick) {
        least = below(series.measured[tick], series.measured[least]) ? tick : least;
        most = below(-series.measured[tick], -series.measured[most]) ? tick : most;
        worst = error(tick) > error(worst) ? tick : worst;
    }
    kept.insert(kept.end(), {least, most, worst});
}

/// Returns the ticks that the page has, ascending: all, or at most `most_report_ticks`.
std::vector<std::size_t> kept_ticks(const Report& report) {
    const std::size_t ticks = report.time_s.size();
    const std::size_t per_stretch = 1 + 3 * report.series.size(); // its first tick, and add_extremes()
    const std::size_t stretches = ticks > most_report_ticks ? most_report_ticks / per_stretch : ticks;
    std::vector<std::size_t> kept;
    for (std::size_t stretch = 0; stretch < stretches; ++stretch) {
        const std::size_t first = stretch * ticks / stretches;
        const std::size_t last = (stretch + 1) * ticks / stretches;
        kept.push_back(first);
        if (last - first > 1) {
            for (const ReportSeries& series : report.series) {
                add_extremes(series, first, last, kept);
            }
        }
    }
    std::ranges::sort(kept);
    kept.erase(std::ranges::unique(kept).begin(), kept.end());
    return kept;
}

template <class Value>
std::vector<Value> at_ticks(const std::vector<Value>& values, const std::vector<std::size_t>& ticks) {
    std::vector<Value> kept;
    kept.reserve(ticks.size());
    for (const std::size_t tick : ticks) {
        kept.push_back(values[tick]);
    }
    return kept;
}

/// Returns the report with the curves at the ticks that the page has.
Report thinned(Report report) {
    const std::size_t ticks = report.time_s.size();
    const std::vector<std::size_t> kept = kept_ticks(report);
    if (kept.size() == ticks) {
        return report;
    }
    report.time_s = at_ticks(report.time_s, kept);
    for (ReportSeries& series : report.series) {
        series.measured = at_ticks(series.measured, kept);
        series.predicted = at_ticks(series.predicted, kept);
        series.standard_deviation = at_ticks(series.standard_deviation, kept);
    }
    if (report.innovation) {
        report.innovation->normalised_squared = at_ticks(report.innovation->normalised_squared, kept);
    }
    report.facts.push_back({"Curves", "the extremes among " + std::to_string(ticks) +
                                          " ticks: " + std::to_string(kept.size()) +
                                          " ticks; dfdyn replay -o writes all as CSV"});
    return report;
}

/// Data for the page's script; arrays in base64: see base64_floats and, for time_s, base64_doubles.
json page_data(const Report& report) {
    json data = {{"time_s", base64_doubles(report.time_s)},
                 {"series", json::array()},
                 {"innovation", nullptr},
                 {"intervals", json::array()},
                 {"marks", json::array()},
                 {"recordings", json::array()}};
    for (const ReportSeries& series : report.series) {
        data["series"].push_back(series_json(series));
    }
    if (report.innovation) {
        data["innovation"] = innovation_json(*report.innovation);
    }
    add_annotations(data, report);
    return data;
}

std::string page_script() {
    std::string script;
    for (const std::string_view part :
         {assets::report_data_js, assets::report_range_js, assets::report_marks_js, assets::report_charts_js,
          assets::report_js}) {
        script += part;
    }
    return script;
}

std::string tables_html(const std::vector<ReportTable>& tables) {
    std::string html;
    for (const ReportTable& table : tables) {
        html += table_html(table);
    }
    return html;
}

} // namespace

std::string render_report(const Report& report) {
    check_time(report.time_s);
    check_series(report);
    check_innovation(report);
    check_annotations(report);
    check_tables(report.tables);
    const Report page = thinned(report);
    return fill_page(assets::report_html,
                     {{"title", escape_html(report.title)},
                      {"summary", escape_html(report.summary)},
                      {"tables", tables_html(report.tables)},
                      {"facts", facts_html(page.facts)},
                      {"data", script_json(page_data(page))},
                      {"style", std::string{assets::report_css}.append(assets::report_charts_css)},
                      {"script", page_script()},
                      {"uplot_style", std::string{assets::uplot_css}},
                      {"uplot_script", std::string{assets::uplot_js}},
                      {"uplot_licence", std::string{assets::uplot_licence}}});
}

} // namespace dfdyn::tools
