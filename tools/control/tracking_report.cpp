// SPDX-License-Identifier: Apache-2.0
#include "tools/control/tracking_report.hpp"

#include "tools/common/atomic_file.hpp"
#include "tools/recording/csv_writer.hpp"
#include "tools/recording/recording.hpp"
#include "tools/report/chart.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace dfdyn::tools {

namespace {

constexpr double mrad_per_rad = 1e3;

std::string fixed(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%9.3f", value);
    return text.data();
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

void write_table(const std::filesystem::path& path, const std::vector<TrackingRun>& runs) {
    const auto joints = static_cast<std::size_t>(runs.front().windows.front().rms.size());
    std::vector<std::string> columns{"feed_forward", "start", "end", "all"};
    for (const char* const prefix : {"joint", "learned_share"}) {
        std::ranges::copy(joint_names(prefix, joints), std::back_inserter(columns));
    }
    AtomicFile file(path);
    CsvWriter csv(file.stream(), columns);
    for (const TrackingRun& run : runs) {
        for (const TrackingWindow& window : run.windows) {
            const JointVector rms = mrad_per_rad * window.rms;
            csv.name(run.name).field(window.start_s).field(window.end_s).field(mrad_per_rad * window.all);
            csv.fields({rms.data(), joints}).fields({window.learned.data(), joints});
            csv.end_row();
        }
    }
    file.commit();
}

} // namespace

void print_tracking(std::ostream& out, const std::vector<TrackingRun>& runs) {
    out << "tracking error, root mean square over all joints, mrad\n  window (s)";
    for (const TrackingRun& run : runs) {
        out << "  " << run.name;
    }
    out << (runs.size() > 1 ? "  ratio\n" : "\n");
    const std::vector<TrackingWindow>& first = runs.front().windows;
    for (std::size_t w = 0; w < first.size(); ++w) {
        out << fixed(first[w].start_s);
        for (const TrackingRun& run : runs) {
            out << fixed(mrad_per_rad * run.windows.at(w).all);
        }
        if (runs.size() > 1) {
            out << fixed(first[w].all / runs.back().windows.at(w).all);
        }
        out << '\n';
    }
}

void write_tracking(const std::filesystem::path& folder, const std::vector<TrackingRun>& runs) {
    make_folder(folder);
    if (runs.front().windows.empty()) {
        return;
    }
    write_table(folder / "tracking.csv", runs);
    std::vector<ChartCurve> curves;
    std::ranges::transform(runs, std::back_inserter(curves), curve_of);
    write_file(folder / "tracking.svg",
               standalone_chart(curve_chart("Tracking error by feed-forward", "time (s)",
                                            "RMS over all joints (mrad)", curves)));
}

} // namespace dfdyn::tools
