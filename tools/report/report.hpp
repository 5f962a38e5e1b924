// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace dfdyn::tools {

/// One output over the ticks of Report::time_s, all three vectors in `unit`. Values that are not finite (no
/// prediction yet) become gaps.
struct ReportSeries {
    std::string name;
    std::string unit;
    std::vector<float> measured;
    std::vector<float> predicted; ///< before the sample was learned
    /// of the prediction, >= 0; the page draws a band of two deviations
    std::vector<float> standard_deviation;
};

/// Normalised innovation squared over all outputs, one per tick (dimensionless). Values that are not finite
/// or not positive become gaps.
struct ReportInnovation {
    std::vector<float> normalised_squared;
    double threshold{};          ///< finite, > 0
    std::string threshold_label; ///< e.g. "99 %, 6 outputs"
};

/// A marked interval on the time axis, e.g. "push".
struct ReportInterval {
    double start_s{};
    double end_s{}; ///< >= start_s
    std::string label;
};

/// The beginning of a recording at `start_s` on the time axis; the time of its first row is `first_t_s`. It
/// ends at the beginning of the next one.
struct ReportRecording {
    double start_s{};
    double first_t_s{};
    std::string name;
};

/// A cell of a table. Numbers are right-aligned, with the number of digits chosen for the whole column.
/// Positive infinity is shown as ∞, and other values that are not finite as a dash.
using ReportCell = std::variant<std::string, double>;

struct ReportTable {
    std::string caption;
    std::vector<std::string> columns;
    std::vector<std::vector<ReportCell>> rows; ///< each as long as `columns`; the first cell names the row
    std::string note;                          ///< below the table, e.g. definitions; may be empty
};

struct ReportFact {
    std::string name;
    std::string value;
};

/// Content of the page. Every string is plain UTF-8 text, which the page escapes. Any part may be empty.
struct Report {
    std::string title;
    std::string summary;
    std::vector<ReportTable> tables;
    std::vector<ReportFact> facts;
    /// one per tick, on the time axis, finite and strictly increasing, also between recordings
    std::vector<double> time_s;
    std::vector<ReportSeries> series;
    std::optional<ReportInnovation> innovation;
    std::vector<ReportInterval> intervals;
    std::vector<ReportRecording> recordings; ///< in order of start_s
    /// Name of the CSV file with all ticks in the page's folder, to which a thinned page links; empty: none
    std::string full_data;
};

/// Largest number of ticks of a page's curves: their intervals are shorter than a pixel of a large screen.
constexpr std::size_t most_report_ticks = 60'000;

/// Returns whether the page has only a part of the ticks.
bool has_thinned_page(const Report& report);

/// Returns the report as one HTML page without external files or network access. Throws std::invalid_argument
/// with the field's name if lengths or times violate the contracts above. Cost O(ticks * series). Above
/// `most_report_ticks` ticks, the page contains the extremes of each output and its error and the largest
/// innovation in intervals of equal length, and the ticks at gaps. It states this, and has no figures of the
/// part in view: the kept ticks are not typical. Size: at most about 16 bytes per kept tick and output, and
/// 150 kB for the page itself.
std::string render_report(const Report& report);

} // namespace dfdyn::tools
