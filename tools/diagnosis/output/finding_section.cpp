// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/finding_section.hpp"

#include "tools/base/numerics/to_vector.hpp"
#include "tools/diagnosis/output/explaining_variable.hpp"
#include "tools/diagnosis/output/finding_words.hpp"
#include "tools/report/xy_chart.hpp"

#include <algorithm>
#include <numeric>

namespace dfdyn::tools {

namespace {

constexpr std::size_t most_dots = 900;
constexpr std::size_t bins = 24;
constexpr std::size_t curve_points = 120;

std::string unit_of(const DiagnosisWork& work, const Finding& finding) {
    return work.diagnosis.torque_units[static_cast<std::size_t>(finding.output)];
}

/// Returns every k-th entry, with the smallest k that leaves at most `most` entries.
std::vector<double> thinned(const Eigen::VectorXd& values, std::size_t most) {
    const auto size = static_cast<std::size_t>(values.size());
    const std::size_t step = (size + most - 1) / std::max<std::size_t>(1, most);
    std::vector<double> result;
    for (std::size_t i = 0; i < size; i += std::max<std::size_t>(1, step)) {
        result.push_back(values[static_cast<Eigen::Index>(i)]);
    }
    return result;
}

/// Returns the effect as a curve over its abscissa: means of its contribution in fine bins.
XyLine fitted_curve(const ExplainingVariable& over, const Eigen::VectorXd& x, const Eigen::VectorXd& share) {
    const std::string name = "named effect";
    if (over.time) {
        return {name, thinned(x, most_dots), thinned(share, most_dots)};
    }
    const XyBins fine = binned(name, to_vector(x), to_vector(share), curve_points);
    return {name, fine.x, fine.mean};
}

PageChart evidence_chart(const DiagnosisWork& work, const Finding& finding, std::size_t number) {
    const ExplainingVariable over = explaining_variable(*work.signals, finding, finding.share);
    const Eigen::VectorXd x = over.value.segment(over.first, over.count);
    const Eigen::VectorXd share = finding.share.segment(over.first, over.count);
    const Eigen::VectorXd error = share + work.rest.col(finding.output).segment(over.first, over.count);
    XyChart chart;
    const std::string& output = work.diagnosis.output_names[static_cast<std::size_t>(finding.output)];
    chart.title =
        std::string("Error of ").append(output).append(" without this effect, the others taken off");
    chart.x_label = over.label;
    chart.y_label = std::string("error (").append(unit_of(work, finding)).append(")");
    chart.points = {"samples", thinned(x, most_dots), thinned(error, most_dots)};
    chart.bins = binned("mean and spread", to_vector(x), to_vector(error), bins);
    chart.lines.push_back(fitted_curve(over, x, share));
    return {"finding_" + std::to_string(number), chart.title, xy_chart(chart)};
}

ReportTable parameter_table(const Finding& finding) {
    ReportTable table{"Parameters", {"parameter", "value", "95 % interval", "unit"}, {}, {}};
    for (const FoundParameter& parameter : finding.parameters) {
        const bool measured = parameter.low < parameter.high;
        const std::optional<std::string> axis = axis_of(parameter);
        table.rows.push_back(
            {parameter.name, axis.value_or(rounded_text(parameter.value)),
             measured ? rounded_text(parameter.low).append(" … ").append(rounded_text(parameter.high))
                      : std::string("–"),
             parameter.unit == "1" ? "" : parameter.unit});
    }
    return table;
}

ReportTable alternatives_table(const Finding& finding) {
    ReportTable table{"Considered and rejected", {"cause", "why not"}, {}, {}};
    for (const OtherCause& other : finding.alternatives) {
        table.rows.push_back({cause_words(other), other.why_not});
    }
    return table;
}

std::string tie_sentence(const Finding& finding) {
    std::string text = "This motion hardly tells it from ";
    for (std::size_t i = 0; i < finding.indistinguishable.size(); ++i) {
        text.append(i == 0 ? "" : "; ").append(cause_words(finding.indistinguishable[i]));
    }
    return text.append(". Any of them may be the true one; the error falls as much with each.");
}

} // namespace

PageSection finding_section(const DiagnosisWork& work, const Finding& finding, std::size_t number) {
    PageSection section;
    section.heading = std::to_string(number) + ". " + cause_words(finding);
    section.paragraphs.push_back(std::string("Confidence ")
                                     .append(confidence_text(finding.confidence))
                                     .append(": ")
                                     .append(finding.evidence)
                                     .append(" ")
                                     .append(unit_of(work, finding))
                                     .append("."));
    if (!finding.indistinguishable.empty()) {
        section.paragraphs.push_back(tie_sentence(finding));
    }
    section.paragraphs.push_back("To settle it, " + finding.confirm + ".");
    section.charts.push_back(evidence_chart(work, finding, number));
    section.tables.push_back(parameter_table(finding));
    if (!finding.alternatives.empty()) {
        section.tables.push_back(alternatives_table(finding));
    }
    return section;
}

} // namespace dfdyn::tools
