// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/finding_section.hpp"

#include "tools/base/numerics/to_vector.hpp"
#include "tools/base/text/instant.hpp"
#include "tools/diagnosis/output/finding_words.hpp"
#include "tools/diagnosis/output/over_time.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"
#include "tools/report/xy_chart.hpp"

#include <algorithm>
#include <numeric>

namespace dfdyn::tools {

namespace {

constexpr Eigen::Index most_dots = 900;
constexpr std::size_t bins = 24;
constexpr std::size_t curve_points = 120;

std::string unit_of(const DiagnosisWork& work, const Finding& finding) {
    return work.diagnosis.torque_units[static_cast<std::size_t>(finding.output)];
}

/// Returns the smallest k with which every k-th entry of `size` are at most `most`.
Eigen::Index thinning_step(Eigen::Index size, Eigen::Index most) {
    return std::max<Eigen::Index>(1, (size + most - 1) / most);
}

std::vector<double> thinned(const Eigen::VectorXd& values, Eigen::Index most) {
    std::vector<double> result;
    for (Eigen::Index i = 0; i < values.size(); i += thinning_step(values.size(), most)) {
        result.push_back(values[i]);
    }
    return result;
}

/// Returns the effect as a curve over its abscissa: over time with the recording's gaps, otherwise as the
/// mean contribution in fine bins.
XyLine fitted_curve(const PlotAbscissa& over, const MeasuredMotion& measured, const Finding& finding) {
    const std::string name = "named effect";
    if (over.time) {
        std::vector<Eigen::Index> rows;
        for (Eigen::Index row = 0; row < over.count; row += thinning_step(over.count, most_dots)) {
            rows.push_back(over.first + row);
        }
        return line_over_time(measured, name, finding.share, rows);
    }
    const Eigen::VectorXd x = over.value.segment(over.first, over.count);
    const Eigen::VectorXd share = finding.share.segment(over.first, over.count);
    const XyBins fine = binned(name, to_vector(x), to_vector(share), curve_points);
    return {name, fine.x, fine.mean};
}

PageChart evidence_chart(const DiagnosisWork& work, const Finding& finding, std::size_t number) {
    const PlotAbscissa over = plot_abscissa(*work.signals, finding, finding.share);
    const Eigen::VectorXd x = over.value.segment(over.first, over.count);
    const Eigen::VectorXd share = finding.share.segment(over.first, over.count);
    const Eigen::VectorXd error = share + finding.rest.segment(over.first, over.count);
    XyChart chart;
    const std::string& output = work.diagnosis.output_names[static_cast<std::size_t>(finding.output)];
    chart.title =
        std::string("Error of ").append(output).append(" without this effect, all other effects subtracted");
    chart.x_label = over.label;
    chart.y_label = std::string("error (").append(unit_of(work, finding)).append(")");
    chart.points = {"samples", thinned(x, most_dots), thinned(error, most_dots)};
    chart.bins = binned("mean and spread", to_vector(x), to_vector(error), bins);
    chart.lines.push_back(fitted_curve(over, work.signals->measured, finding));
    return {"finding_" + std::to_string(number), chart.title, xy_chart(chart)};
}

ReportTable parameter_table(const Finding& finding) {
    ReportTable table{"Parameters", {"parameter", "value", "95 % interval", "unit"}, {}, {}};
    for (const FoundParameter& parameter : finding.parameters) {
        const bool measured = parameter.low < parameter.high;
        const std::optional<std::string> axis = axis_of(parameter);
        const bool date = parameter.unit == "s" && is_epoch_time(parameter.value);
        const auto text = [date](double value) { return date ? instant_text(value) : rounded_text(value); };
        table.rows.push_back(
            {parameter.name, axis.value_or(text(parameter.value)),
             measured ? text(parameter.low).append(" … ").append(text(parameter.high)) : std::string("–"),
             parameter.unit == "1" || date ? "" : parameter.unit});
    }
    return table;
}

/// Returns the main parameter in each of several recordings.
ReportTable recordings_table(const Finding& finding) {
    const std::string unit = finding.parameters.front().unit;
    ReportTable table{finding.parameters.front().name + " in each recording",
                      {"recording", "value (" + unit + ")", "95 % interval"},
                      {},
                      "Standard deviation between recordings: " + rounded_text(finding.spread) + " " + unit +
                          ", which the interval above includes. A recording with little information has a "
                          "value near the common one."};
    for (const ValueOfRecording& one : finding.by_recording) {
        table.rows.push_back({one.recording, rounded_text(one.value),
                              rounded_text(one.low).append(" … ").append(rounded_text(one.high))});
    }
    return table;
}

ReportTable alternatives_table(const Finding& finding) {
    ReportTable table{"Considered and rejected", {"cause", "reason"}, {}, {}};
    for (const OtherCause& other : finding.alternatives) {
        table.rows.push_back({cause_words(other), other.why_not});
    }
    return table;
}

std::string tie_sentence(const Finding& finding) {
    return "This motion hardly distinguishes it from " + tie_words(finding) +
           ". Each of them may be the true cause: all reduce the error equally.";
}

} // namespace

PageSection finding_section(const DiagnosisWork& work, const Finding& finding, std::size_t number) {
    PageSection section;
    section.heading = std::to_string(number) + ". " + cause_words(finding);
    section.paragraphs.push_back(std::string("Confidence ")
                                     .append(confidence_text(finding.confidence))
                                     .append(": ")
                                     .append(finding.evidence)
                                     .append("."));
    if (!finding.indistinguishable.empty()) {
        section.paragraphs.push_back(tie_sentence(finding));
    }
    section.paragraphs.push_back("Confirming experiment, " + finding.confirm + ".");
    section.charts.push_back(evidence_chart(work, finding, number));
    section.tables.push_back(parameter_table(finding));
    if (!finding.by_recording.empty()) {
        section.tables.push_back(recordings_table(finding));
    }
    if (!finding.alternatives.empty()) {
        section.tables.push_back(alternatives_table(finding));
    }
    return section;
}

} // namespace dfdyn::tools
