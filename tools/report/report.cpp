// SPDX-License-Identifier: Apache-2.0
#include "tools/report/report.hpp"

#include "tools/report/page_curves.hpp"
#include "tools/report/page_text.hpp"
#include "tools/report/report_assets.hpp"
#include "tools/report/report_table.hpp"

#include <nlohmann/json.hpp>

#include <cctype>
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
    for (const ReportRecording& recording : report.recordings) {
        data["recordings"].push_back(
            {{"start_s", recording.start_s}, {"first_t_s", recording.first_t_s}, {"name", recording.name}});
    }
}

/// Percent-encodes a file's name for a link.
std::string link_to(std::string_view name) {
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string link = "./";
    for (const char character : name) {
        const auto byte = static_cast<unsigned char>(character);
        if (byte < 0x80 &&
            (std::isalnum(byte) != 0 || std::string_view("-._~").find(character) != std::string_view::npos)) {
            link += character;
        } else {
            link.append({'%', digits[byte >> 4U], digits[byte & 15U]});
        }
    }
    return link;
}

/// Returns a paragraph about the ticks that are not in the page; empty if all are.
std::string thinning_html(const Report& report, std::size_t kept) {
    if (!has_thinned_page(report)) {
        return "";
    }
    const std::string all = std::to_string(report.time_s.size());
    return "<p>The curves contain " + std::to_string(kept) + " of " + all +
           " ticks, among them the extremes of outputs, errors and innovations. Figures of the part in view "
           "need all ticks and are left out. All ticks " +
           (report.full_data.empty() ? "are in the table that <code>dfdyn replay -o</code> writes"
                                     : "are in <a href=\"" + link_to(report.full_data) + "\">" +
                                           escape_html(report.full_data) + "</a>") +
           ".</p>";
}

/// Data for the page's script; arrays in base64: see base64_floats and, for time_s, base64_doubles.
json page_data(const PageCurves& curves) {
    const Report& report = curves.report;
    json data = {{"time_s", base64_doubles(report.time_s)},
                 {"sample_time_s", curves.sample_time_s},
                 {"thinned", curves.thinned},
                 {"breaks", curves.breaks},
                 {"series", json::array()},
                 {"innovation", nullptr},
                 {"intervals", json::array()},
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
    const PageCurves page = page_curves(report);
    PageParts parts;
    parts.title = report.title;
    parts.summary = report.summary;
    parts.remark = thinning_html(report, page.report.time_s.size());
    parts.style = std::string{assets::uplot_css}
                      .append("\n")
                      .append(assets::report_css)
                      .append(assets::report_charts_css);
    parts.content = fill_page(assets::report_content_html,
                              {{"tables", tables_html(report.tables)}, {"facts", facts_html(report.facts)}});
    parts.notice = "<!-- The charts are drawn by uPlot, which is included below under this licence:\n" +
                   std::string{assets::uplot_licence} + "\n-->\n";
    parts.scripts = fill_page(assets::report_scripts_html, {{"data", script_json(page_data(page))},
                                                            {"uplot_script", std::string{assets::uplot_js}},
                                                            {"script", page_script()}});
    parts.script_policy = "; script-src 'unsafe-inline'";
    return page_html(parts);
}

} // namespace dfdyn::tools
