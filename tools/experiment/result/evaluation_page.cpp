// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/evaluation_page.hpp"

#include "tools/base/system/file_set.hpp"
#include "tools/build_flags.hpp"
#include "tools/experiment/result/comparison.hpp"
#include "tools/experiment/result/error_curve.hpp"
#include "tools/experiment/result/evaluation_tables.hpp"
#include "tools/experiment/result/phase_error.hpp"
#include "tools/report/chart.hpp"
#include "tools/report/figure_page.hpp"
#include "tools/report/report_table.hpp"

#include <array>
#include <cstdio>
#include <sstream>

namespace dfdyn::tools {

namespace {

constexpr int points_per_decade = 40;

std::string seconds(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%g s", value);
    return text.data();
}

std::string counted(std::size_t count, const std::string& thing) {
    return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

/// Results of an evaluation in words, pictures and tables.
class EvaluationPage {
  public:
    EvaluationPage(const Plan& plan, const PlanData& data, const EvaluationResults& results)
        : plan_(plan), data_(data), results_(results), findings_(judge_findings(plan, results.jobs)),
          comparisons_(compare_all(plan.comparisons, plan, results.jobs)) {}

    FigurePage page() const {
        FigurePage page{plan_.title, protocol_sentence(), finding_sections(), {{"Build", build_flags()}}};
        for (std::size_t figure = 0; figure < plan_.figures.size(); ++figure) {
            page.sections.push_back(figure_section(figure));
        }
        page.sections.push_back({"Figures of all cases", {error_sentence()}, {}, tables()});
        if (!results_.failed.empty()) {
            page.sections.push_back(failures());
        }
        return page;
    }

    /// The verdicts, and the reasons why findings are not reproduced.
    FigurePage verdicts() const { return {plan_.title, protocol_sentence(), verdict_sections(), {}}; }

    std::string tables_markdown() const {
        std::string text;
        for (const ReportTable& table : tables()) {
            text += table_markdown(table) + "\n";
        }
        return text;
    }

  private:
    const std::vector<std::string>& outputs() const { return data_.start.output.names; }

    ChartCurve curve_of(const std::string& name, std::size_t group) const {
        const ErrorCurve curve =
            thinned(error_curve(draws_of(results_.jobs, name), group), points_per_decade);
        return {name, curve.time_s, curve.mean, curve.low, curve.high};
    }

    ChartBox box_of_case(const std::string& name, std::size_t group) const {
        const Box box = phase_box(draws_of(results_.jobs, name), group, Phase::steady, plan_.steady_after_s);
        return {name, box.low, box.lower_quartile, box.median, box.upper_quartile, box.high, box.mean};
    }

    PageChart curves(const Figure& figure, std::size_t group, const std::string& file) const {
        std::vector<ChartCurve> curves;
        for (const std::string& name : figure.cases) {
            curves.push_back(curve_of(name, group));
        }
        const std::string title = error_of(group) + ", mean over subsets and draws";
        return {file + "_curves", title, curve_chart(title, "time since the subset's start, s", "ε", curves)};
    }

    PageChart boxes(const Figure& figure, std::size_t group, const std::string& file) const {
        std::vector<ChartBox> boxes;
        for (const std::string& name : figure.cases) {
            boxes.push_back(box_of_case(name, group));
        }
        const std::string title = error_of(group) + ", after " + seconds(plan_.steady_after_s);
        return {file + "_boxes", title, box_chart(title, "ε", boxes)};
    }

    std::string error_of(std::size_t group) const { return "ε of " + plan_.groups[group].name; }

    PageSection figure_section(std::size_t number) const {
        const Figure& figure = plan_.figures[number];
        PageSection section{figure.title, {}, {}, {}};
        if (number == 0) {
            section.paragraphs = {error_sentence(), picture_sentence()};
        }
        for (std::size_t group = 0; group < plan_.groups.size(); ++group) {
            const std::string file =
                plan_.name + "_" + std::to_string(number + 1) + "_" + plan_.groups[group].name;
            section.charts.push_back(curves(figure, group, file));
            section.charts.push_back(boxes(figure, group, file));
        }
        return section;
    }

    std::string scale_sentence() const {
        return plan_.error_scale == ErrorScale::horizon
                   ? "relative to the squared output over the same samples, as in the paper"
                   : "relative to the output's variance over all subsets";
    }

    std::string protocol_sentence() const {
        return "Hyperparameters and start from the first " + std::to_string(plan_.start_rows) + " rows of " +
               plan_.training_log.filename().string() + ", online over its other " +
               std::to_string(data_.online.row_count()) + "; then each of " +
               counted(data_.subsets.size(), "subset") + " from the state reached, learning on. " +
               counted(plan_.cases.size(), "case") + ", " + counted(plan_.seeds.size(), "draw") +
               " of random features each.";
    }

    std::string error_sentence() const {
        return "ε: squared error over the next " + std::to_string(plan_.horizon) +
               " samples, predicted by the model as it was before them, " + scale_sentence() +
               "; averaged over the outputs of the group. Transient: the first " +
               seconds(plan_.steady_after_s) + " of a subset, steady state: what follows.";
    }

    static std::string picture_sentence() {
        return "Curves: mean over subsets and draws, and over a fortieth of a decade of time; the band holds "
               "the middle half of the draws. Boxes: median and quartiles over all times, subsets and draws "
               "of the steady state, whiskers at 5 and 95 %, a dot at the mean.";
    }

    static std::string rule_sentence() {
        return "A comparison pairs the draws of two cases and averages over the subsets: the mean of ε in "
               "the transient, its median in the steady state. It holds if the exact one-sided signed-rank "
               "test over the draws gives p < 0.05 and most subsets agree. It is contradicted if the test of "
               "the opposite gives p < 0.05; otherwise it is undecided, as always with fewer than five "
               "draws. "
               "A finding is reproduced if all its comparisons hold, and partly reproduced if more hold than "
               "are contradicted. It is undecided if none holds and none is contradicted; otherwise it is "
               "not reproduced.";
    }

    std::vector<ReportTable> tables() const {
        std::vector<ReportTable> tables;
        for (std::size_t group = 0; group < plan_.groups.size(); ++group) {
            tables.push_back(error_table(plan_, results_.jobs, group));
        }
        tables.push_back(step_error_table(plan_, results_.jobs, results_.opponents, outputs()));
        tables.push_back(cost_table(plan_, results_.jobs));
        return tables;
    }

    PageSection failures() const {
        PageSection section{"Not done", {}, {}, {}};
        for (const FailedJob& job : results_.failed) {
            section.paragraphs.push_back(job.case_name + ", draw " + std::to_string(job.seed) + ": " +
                                         job.reason);
        }
        return section;
    }

    static PageSection finding_section(const FindingOutcome& outcome) {
        PageSection section{outcome.finding->name + ": " + to_string(outcome.verdict),
                            {outcome.finding->statement},
                            {},
                            {comparison_table("Comparisons", outcome.comparisons)}};
        if (needs_reason(outcome)) {
            section.paragraphs.push_back("Why it is " + to_string(outcome.verdict) + ": " +
                                         outcome.finding->if_not);
        }
        return section;
    }

    static bool needs_reason(const FindingOutcome& outcome) {
        return outcome.verdict != FindingVerdict::reproduced && !outcome.finding->if_not.empty();
    }

    std::vector<PageSection> verdict_sections() const {
        PageSection reasons{"Why not all are reproduced", {}, {}, {}};
        for (const FindingOutcome& outcome : findings_) {
            if (needs_reason(outcome)) {
                reasons.paragraphs.push_back(outcome.finding->name + " (" + to_string(outcome.verdict) +
                                             "): " + outcome.finding->if_not);
            }
        }
        std::vector<PageSection> sections;
        sections.push_back({"Findings", {rule_sentence()}, {}, {finding_table(findings_)}});
        if (!reasons.paragraphs.empty()) {
            sections.push_back(reasons);
        }
        return sections;
    }

    std::vector<PageSection> finding_sections() const {
        std::vector<PageSection> sections;
        if (!findings_.empty()) {
            sections.push_back({"Findings", {rule_sentence()}, {}, {finding_table(findings_)}});
        }
        for (const FindingOutcome& outcome : findings_) {
            sections.push_back(finding_section(outcome));
        }
        if (!comparisons_.empty()) {
            sections.push_back(
                {"Comparisons", {rule_sentence()}, {}, {comparison_table("Comparisons", comparisons_)}});
        }
        return sections;
    }

    const Plan& plan_;
    const PlanData& data_;
    const EvaluationResults& results_;
    std::vector<FindingOutcome> findings_;
    std::vector<ComparisonOutcome> comparisons_;
};

} // namespace

void write_evaluation(const std::filesystem::path& folder, const Plan& plan, const PlanData& data,
                      const EvaluationResults& results) {
    FileSet files;
    files.add_folder(folder / "pictures");
    const EvaluationPage evaluation(plan, data, results);
    const FigurePage page = evaluation.page();
    std::ostringstream csv;
    write_results_csv(csv, plan, results.jobs, results.opponents, data.start.output.names);
    files.add(folder / "results.csv", csv.str());
    files.add(folder / "tables.md", evaluation.tables_markdown());
    files.add(folder / "report.html", render_figure_page(page));
    files.add(folder / "findings.md", figure_page_markdown(page));
    files.add(folder / "verdicts.md", figure_page_markdown(evaluation.verdicts()));
    for (const PageSection& section : page.sections) {
        for (const PageChart& chart : section.charts) {
            files.add(folder / "pictures" / (chart.name + ".svg"), standalone_chart(chart.svg));
        }
    }
    files.commit();
}

} // namespace dfdyn::tools
