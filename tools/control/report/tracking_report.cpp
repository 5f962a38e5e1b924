// SPDX-License-Identifier: Apache-2.0
#include "tools/control/report/tracking_report.hpp"

#include "tools/base/recording/csv_writer.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/text/number.hpp"
#include "tools/build_flags.hpp"
#include "tools/report/chart.hpp"
#include "tools/report/figure_page.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double mrad_per_rad = 1e3;

std::string fixed(double value, int width) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%*.3f", width, value);
    return text.data();
}

/// Ratio of the first run's error to the last run's.
double ratio(const std::vector<TrackingRun>& runs, std::size_t window) {
    return runs.front().windows.at(window).all / runs.back().windows.at(window).all;
}

ChartCurve curve_of(const TrackingRun& run) {
    ChartCurve curve;
    curve.name = run.name;
    for (const TrackingWindow& window : run.windows) {
        curve.x.push_back(window.end_s);
        curve.y.push_back(mrad_per_rad * window.all);
    }
    curve.low = curve.high = curve.y;
    return curve;
}

void write_table(std::ostream& out, const std::vector<TrackingRun>& runs) {
    const auto joints = static_cast<std::size_t>(runs.front().windows.front().rms.size());
    std::vector<std::string> columns{"feed_forward", "start", "end", "all"};
    for (const char* const prefix : {"joint", "learned_share"}) {
        std::ranges::copy(joint_names(prefix, joints), std::back_inserter(columns));
    }
    CsvWriter csv(out, columns);
    for (const TrackingRun& run : runs) {
        for (const TrackingWindow& window : run.windows) {
            const JointVector rms = mrad_per_rad * window.rms;
            csv.name(run.name).field(window.start_s).field(window.end_s).field(mrad_per_rad * window.all);
            csv.fields({rms.data(), joints}).fields({window.learned.data(), joints});
            csv.end_row();
        }
    }
}

ReportTable window_table(const std::vector<TrackingRun>& runs) {
    ReportTable table{"RMS over all joints, mrad", {"window (s)"}, {}, {}};
    for (const TrackingRun& run : runs) {
        table.columns.push_back(run.name);
    }
    if (runs.size() > 1) {
        table.columns.emplace_back("ratio");
    }
    const std::vector<TrackingWindow>& first = runs.front().windows;
    for (std::size_t w = 0; w < first.size(); ++w) {
        std::vector<ReportCell> row{number_text(first[w].start_s) + " to " + number_text(first[w].end_s)};
        for (const TrackingRun& run : runs) {
            row.emplace_back(mrad_per_rad * run.windows.at(w).all);
        }
        if (runs.size() > 1) {
            row.emplace_back(ratio(runs, w));
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

std::string curves_of(const std::vector<TrackingRun>& runs) {
    std::vector<ChartCurve> curves;
    std::ranges::transform(runs, std::back_inserter(curves), curve_of);
    return curve_chart("Tracking error by feed-forward", "time (s)", "RMS over all joints (mrad)", curves);
}

} // namespace

void print_tracking(std::ostream& out, const std::vector<TrackingRun>& runs) {
    if (runs.front().windows.empty()) {
        return;
    }
    const bool compared = runs.size() > 1;
    out << "tracking error, root mean square over all joints, mrad\n  window (s)";
    for (const TrackingRun& run : runs) {
        out << "  " << run.name;
    }
    out << (compared ? "    ratio\n" : "\n");
    const std::vector<TrackingWindow>& first = runs.front().windows;
    for (std::size_t w = 0; w < first.size(); ++w) {
        out << fixed(first[w].start_s, 12);
        for (const TrackingRun& run : runs) {
            out << fixed(mrad_per_rad * run.windows.at(w).all, static_cast<int>(run.name.size()) + 2);
        }
        out << (compared ? fixed(ratio(runs, w), 9) : "") << '\n';
    }
}

nlohmann::ordered_json tracking_json(const std::vector<TrackingRun>& runs, bool stopped) {
    nlohmann::ordered_json json{
        {"schema", "dfdyn.loop/1"}, {"stopped", stopped}, {"runs", nlohmann::ordered_json::array()}};
    for (const TrackingRun& run : runs) {
        nlohmann::ordered_json windows = nlohmann::ordered_json::array();
        for (const TrackingWindow& window : run.windows) {
            windows.push_back({{"start_s", window.start_s},
                               {"end_s", window.end_s},
                               {"rms_rad", std::vector<double>(window.rms.begin(), window.rms.end())},
                               {"rms_all_rad", window.all}});
        }
        json["runs"].push_back({{"name", run.name}, {"windows", std::move(windows)}});
    }
    return json;
}

void add_tracking(const std::filesystem::path& folder, const std::string& title,
                  const std::vector<TrackingRun>& runs, FileSet& files) {
    if (runs.front().windows.empty()) {
        return;
    }
    write_table(files.add(folder / "tracking.csv"), runs);
    const std::string chart = curves_of(runs);
    files.add(folder / "tracking.svg", standalone_chart(chart));
    const std::string summary =
        "Reference minus true position, root mean square over windows of time: "
        "feedback and feed-forward of the nominal rigid body, and of a learned model.";
    const FigurePage page{
        title,
        summary,
        {{"Tracking error", {}, {{"tracking", "Tracking error", chart}}, {window_table(runs)}}},
        {{"Build", build_flags()}}};
    files.add(folder / "tracking.html", render_figure_page(page));
}

} // namespace dfdyn::tools
