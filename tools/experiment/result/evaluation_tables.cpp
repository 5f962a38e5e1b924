// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/evaluation_tables.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/experiment/result/phase_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace dfdyn::tools {

namespace {

template <class Value>
double median_over(const std::vector<const JobResult*>& draws, const Value& value) {
    std::vector<double> values;
    std::ranges::transform(draws, std::back_inserter(values),
                           [&](const JobResult* draw) { return static_cast<double>(value(*draw)); });
    return median(std::move(values));
}

/// Returns the interquartile range of the draws' values as text.
template <class Value>
std::string spread_over(const std::vector<const JobResult*>& draws, const Value& value) {
    std::vector<double> values;
    std::ranges::transform(draws, std::back_inserter(values),
                           [&](const JobResult* draw) { return value(*draw); });
    const Box box = box_of(std::move(values));
    if (std::isnan(box.lower_quartile)) {
        return "–"; // no draw has a value
    }
    const auto shown_as = [](double number) {
        return std::isinf(number) ? std::string("∞") : formatted("%.3g", number);
    };
    return shown_as(box.lower_quartile) + "–" + shown_as(box.upper_quartile);
}

/// Returns the rows of a table, one for each case that has a draw.
template <class Cells>
std::vector<std::vector<ReportCell>> rows_of_cases(const Plan& plan, std::span<const JobResult> jobs,
                                                   const Cells& cells) {
    std::vector<std::vector<ReportCell>> rows;
    for (const Case& one : plan.cases) {
        const std::vector<const JobResult*> draws = draws_of(jobs, one.name);
        if (!draws.empty()) {
            rows.push_back({one.name});
            std::ranges::copy(cells(draws), std::back_inserter(rows.back()));
        }
    }
    return rows;
}

std::string claim_of(const Comparison& comparison) {
    const std::string phase = comparison.phase == Phase::transient ? "transient" : "steady state";
    if (comparison.gain == 0) {
        return "less, " + phase;
    }
    return comparison.gain > 0 ? "at least " + ratio_text(1 - comparison.gain) + ", " + phase
                               : "at most " + ratio_text(1 - comparison.gain) + ", " + phase;
}

std::string share_text(std::size_t part, std::size_t whole) {
    return std::to_string(part) + " of " + std::to_string(whole);
}

void write_phase(std::ostream& out, const JobResult& job, std::size_t group, Phase phase,
                 double steady_after_s) {
    const JobResult* const draw = &job;
    const Box box = phase_box({&draw, 1}, group, phase, steady_after_s);
    for (const double value :
         {box.mean, box.median, box.lower_quartile, box.upper_quartile, box.low, box.high}) {
        out << ',' << number_text(value);
    }
}

} // namespace

std::vector<const JobResult*> draws_of(std::span<const JobResult> jobs, const std::string& case_name) {
    std::vector<const JobResult*> draws;
    for (const JobResult& job : jobs) {
        if (job.case_name == case_name) {
            draws.push_back(&job);
        }
    }
    return draws;
}

namespace {

/// Returns a list of the texts of all cases with results; empty texts are left out.
template <class TextOf>
std::string list_of_cases(const Plan& plan, std::span<const JobResult> jobs, const TextOf& text_of) {
    std::vector<std::string> cases;
    for (const Case& one : plan.cases) {
        const std::vector<const JobResult*> draws = draws_of(jobs, one.name);
        const std::string text = draws.empty() ? std::string() : text_of(one, draws);
        if (!text.empty()) {
            cases.push_back(text);
        }
    }
    return listed(cases);
}

std::string error_note(const Plan& plan, std::span<const JobResult> jobs, std::size_t group) {
    using Draws = std::vector<const JobResult*>;
    const std::string lost = list_of_cases(plan, jobs, [&](const Case& one, const Draws& draws) {
        const double share = lost_share(draws, group);
        return share > 0 ? one.name + " " + formatted("%.3g", 100 * share) + " %" : std::string();
    });
    const std::string same = list_of_cases(plan, jobs, [](const Case& one, const Draws&) {
        return !structure(one.model).features ? one.name : std::string();
    });
    std::string note =
        "Times of all draws and subsets together; its draws: the middle half of the draws, each "
        "with all its subsets.";
    note += same.empty() ? "" : " No random features, so that all draws are the same: " + same + ".";
    note += lost.empty() ? "" : " Lost, without a prediction, and counted as infinite: " + lost + ".";
    return note;
}

} // namespace

ReportTable error_table(const Plan& plan, std::span<const JobResult> jobs, std::size_t group) {
    const auto box_of_draws = [&](std::span<const JobResult* const> draws, Phase phase) {
        return phase_box(draws, group, phase, plan.steady_after_s);
    };
    const auto box_of_draw = [&](const JobResult& draw, Phase phase) {
        const JobResult* const one = &draw;
        return box_of_draws({&one, 1}, phase);
    };
    ReportTable table;
    table.caption = "ε of " + plan.groups[group].name;
    table.columns = {"case",
                     "transient, mean",
                     "its draws, 25–75 %",
                     "transient, median",
                     "steady state, mean",
                     "median",
                     "its draws, 25–75 %",
                     "25 %",
                     "75 %",
                     "5 %",
                     "95 %"};
    table.rows = rows_of_cases(plan, jobs, [&](const std::vector<const JobResult*>& draws) {
        const Box transient = box_of_draws(draws, Phase::transient);
        const Box steady = box_of_draws(draws, Phase::steady);
        const std::string means = spread_over(
            draws, [&](const JobResult& draw) { return box_of_draw(draw, Phase::transient).mean; });
        const std::string medians = spread_over(
            draws, [&](const JobResult& draw) { return box_of_draw(draw, Phase::steady).median; });
        return std::vector<ReportCell>{
            transient.mean, means,      transient.median,      steady.mean,
            steady.median,  medians,    steady.lower_quartile, steady.upper_quartile,
            steady.low,     steady.high};
    });
    table.note = error_note(plan, jobs, group);
    return table;
}

ReportTable step_error_table(const Plan& plan, std::span<const JobResult> jobs,
                             const PlanOpponents& opponents, const std::vector<std::string>& outputs) {
    ReportTable table;
    table.caption = "nRMSE, one step";
    table.columns = {"case"};
    table.columns.insert(table.columns.end(), outputs.begin(), outputs.end());
    table.rows = rows_of_cases(plan, jobs, [&](const std::vector<const JobResult*>& draws) {
        std::vector<ReportCell> errors;
        for (std::size_t output = 0; output < outputs.size(); ++output) {
            errors.emplace_back(
                median_over(draws, [&](const JobResult& draw) { return draw.normalised_error[output]; }));
        }
        return errors;
    });
    table.note =
        "rms(measured − predicted) / std(measured) over all subsets, predicted one sample ahead where "
        "there is a prediction; the median over the draws.";
    for (const OpponentErrors& opponent : opponents.errors) {
        table.rows.push_back({opponent.label});
        std::ranges::copy(opponent.normalised_error, std::back_inserter(table.rows.back()));
    }
    if (!opponents.errors.empty()) {
        table.note += " Persistence and AR(2) see the measured outputs before each sample, the rigid bodies "
                      "with friction its motion alone.";
    }
    if (!opponents.no_rigid_body.empty()) {
        table.note += " No rigid body: " + opponents.no_rigid_body + ".";
    }
    return table;
}

ReportTable cost_table(const Plan& plan, std::span<const JobResult> jobs) {
    ReportTable table;
    table.caption = "Cost";
    table.columns = {"case", "columns", "multiply-adds per tick", "state, bytes", "µs per tick, median"};
    table.rows = rows_of_cases(plan, jobs, [](const std::vector<const JobResult*>& draws) {
        return std::vector<ReportCell>{
            static_cast<double>(draws.front()->columns), static_cast<double>(draws.front()->operations),
            static_cast<double>(draws.front()->state_bytes),
            median_over(draws, [](const JobResult& draw) { return draw.median_us; })};
    });
    table.note = "Times are of the machine that ran this, under other load.";
    return table;
}

ReportTable comparison_table(const std::string& caption, std::span<const ComparisonOutcome> outcomes) {
    ReportTable table;
    table.caption = caption;
    table.columns = {"case",
                     "against",
                     "group",
                     "claim: its error is",
                     "it is, median over draws",
                     "draws, 25–75 %",
                     "draws agree",
                     "subsets agree",
                     "p",
                     "verdict"};
    for (const ComparisonOutcome& outcome : outcomes) {
        const Comparison& comparison = outcome.comparison;
        table.rows.push_back({comparison.better, comparison.worse, comparison.group, claim_of(comparison),
                              ratio_text(outcome.median_ratio),
                              ratio_text(outcome.lower_ratio) + " – " + ratio_text(outcome.upper_ratio),
                              share_text(outcome.draws_agree, outcome.draws),
                              share_text(outcome.subsets_agree, outcome.subsets),
                              formatted("%.2g", outcome.p_holds), to_string(outcome.verdict)});
    }
    return table;
}

ReportTable finding_table(std::span<const FindingOutcome> findings) {
    ReportTable table;
    table.caption = "Findings";
    table.columns = {"finding", "comparisons that hold", "contradicted", "undecided", "verdict"};
    for (const FindingOutcome& outcome : findings) {
        std::vector<ReportCell> row{outcome.finding->name};
        for (const Verdict verdict : {Verdict::holds, Verdict::contradicted, Verdict::undecided}) {
            row.emplace_back(static_cast<double>(
                std::ranges::count(outcome.comparisons, verdict, &ComparisonOutcome::verdict)));
        }
        row.emplace_back(to_string(outcome.verdict));
        table.rows.push_back(std::move(row));
    }
    return table;
}

namespace {

/// Writes the row of an alternative method, which has no draw, no group, no ε and no cost.
void write_opponent(std::ostream& out, const OpponentErrors& opponent) {
    const auto nothing = [&out](int columns) {
        for (int column = 0; column < columns; ++column) {
            out << ",nan";
        }
    };
    out << opponent.label << ",0,";
    nothing(12);
    for (const double error : opponent.normalised_error) {
        out << ',' << number_text(error);
    }
    nothing(5);
    out << '\n';
}

} // namespace

void write_results_csv(std::ostream& out, const Plan& plan, std::span<const JobResult> jobs,
                       const PlanOpponents& opponents, const std::vector<std::string>& outputs) {
    out << "case,seed,group";
    for (const std::string phase : {"transient", "steady"}) {
        for (const std::string figure : {"mean", "median", "q25", "q75", "q05", "q95"}) {
            out << ',' << phase << '_' << figure;
        }
    }
    for (const std::string& output : outputs) {
        out << ",nrmse_" << output;
    }
    out << ",lost,median_us,operations,state_bytes,columns\n";
    for (const JobResult& job : jobs) {
        for (std::size_t group = 0; group < plan.groups.size(); ++group) {
            out << job.case_name << ',' << job.seed << ',' << plan.groups[group].name;
            write_phase(out, job, group, Phase::transient, plan.steady_after_s);
            write_phase(out, job, group, Phase::steady, plan.steady_after_s);
            for (const double error : job.normalised_error) {
                out << ',' << number_text(error);
            }
            const JobResult* const draw = &job;
            out << ',' << number_text(lost_share({&draw, 1}, group)) << ',' << number_text(job.median_us)
                << ',' << job.operations << ',' << job.state_bytes << ',' << job.columns << '\n';
        }
    }
    for (const OpponentErrors& opponent : opponents.errors) {
        write_opponent(out, opponent);
    }
}

} // namespace dfdyn::tools
