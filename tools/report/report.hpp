// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace dfdyn::tools {

/// One output over the ticks of Report::time_s, all three in `unit`. Values that are not finite (no
/// prediction yet) become gaps.
struct ReportSeries {
    std::string name;
    std::string unit;
    std::vector<float> measured;
    std::vector<float> predicted;          ///< before the sample was learned
    std::vector<float> standard_deviation; ///< of the prediction, >= 0; the page draws the band of +-2 of it
};

/// The normalised innovation squared over all outputs, one per tick (dimensionless); what is not finite or
/// not positive is a gap.
struct ReportInnovation {
    std::vector<float> normalised_squared;
    double threshold{};          ///< finite, > 0
    std::string threshold_label; ///< e.g. "99 %, 6 outputs"
};

/// A marked stretch of plot time, e.g. "push".
struct ReportInterval {
    double start_s{};
    double end_s{}; ///< >= start_s
    std::string label;
};

/// A marked instant of plot time.
struct ReportMark {
    double time_s{};
    std::string label;
};

/// A recording begins at `start_s` of plot time with the row whose own time is `first_t_s`, and ends where
/// the next one begins.
struct ReportRecording {
    double start_s{};
    double first_t_s{};
    std::string name;
};

/// A number is shown with digits that suit its whole column, right-aligned; an infinite one above as ∞, any
/// other that is not finite as a dash.
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

/// What the page shows. Every string is plain UTF-8 text; the page escapes it. Everything may be empty.
struct Report {
    std::string title;
    std::string summary;
    std::vector<ReportTable> tables;
    std::vector<ReportFact> facts;
    std::vector<double> time_s; ///< plot time, one per tick, finite and strictly increasing, also from one
                                ///< recording to the next
    std::vector<ReportSeries> series;
    std::optional<ReportInnovation> innovation;
    std::vector<ReportInterval> intervals;
    std::vector<ReportMark> marks;
    std::vector<ReportRecording> recordings; ///< in order of start_s
};

/// The report as one HTML page that needs no other file and no network. Throws std::invalid_argument that
/// names the field when lengths or times contradict the contracts above. Size and cost O(ticks * series):
/// about 16 bytes per tick and output, and 150 kB for the page itself.
std::string render_report(const Report& report);

} // namespace dfdyn::tools
