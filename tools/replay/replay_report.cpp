// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay_report.hpp"

#include "tools/base/text/number.hpp"
#include "tools/build_flags.hpp"
#include "tools/model/output_units.hpp"

#include <numeric>

namespace dfdyn::tools {

namespace {

/// Gap between recordings on the time axis (s), which separates their curves.
constexpr double pause_between_recordings_s = 1;

void add_times(std::span<const ReplayedRecording> replayed, const ReplaySummary& summary, Report& report) {
    double offset = 0;
    for (std::size_t i = 0; i < replayed.size(); ++i) {
        const std::vector<double>& time_s = replayed[i].time_s;
        if (time_s.empty()) {
            continue;
        }
        report.recordings.push_back({offset, time_s.front(), summary.recordings[i].name});
        for (const Contradiction& contradiction : summary.recordings[i].contradictions) {
            report.intervals.push_back({offset + contradiction.start_s - time_s.front(),
                                        offset + contradiction.end_s - time_s.front(),
                                        "contradicts the model"});
        }
        for (const double t : time_s) {
            report.time_s.push_back(offset + t - time_s.front());
        }
        offset = report.time_s.back() + pause_between_recordings_s;
    }
}

/// Adds the values of output number `output` of `outputs` to a series that has none.
void add_values(std::span<const ReplayedRecording> replayed, std::size_t output, std::size_t outputs,
                ReportSeries& series) {
    for (const ReplayedRecording& recording : replayed) {
        for (std::size_t tick = 0; tick < recording.time_s.size(); ++tick) {
            const std::size_t element = tick * outputs + output;
            series.measured.push_back(static_cast<float>(recording.measured[element]));
            series.predicted.push_back(recording.predicted[element]);
            series.standard_deviation.push_back(recording.standard_deviation[element]);
        }
    }
}

std::vector<ReportCell> table_row(const std::string& label, const std::vector<double>& values) {
    std::vector<ReportCell> cells{label};
    cells.insert(cells.end(), values.begin(), values.end());
    return cells;
}

ReportTable table_of(const RecordingFigures& figures, const ReplaySummary& summary) {
    ReportTable table;
    table.caption = figures.name;
    table.columns = {"error"};
    table.columns.insert(table.columns.end(), summary.outputs.begin(), summary.outputs.end());
    table.rows = {table_row("nRMSE, one step", figures.normalised_error)};
    for (const OpponentErrors& opponent : figures.opponents) {
        table.rows.push_back(table_row("nRMSE, one step, " + opponent.label, opponent.normalised_error));
    }
    table.rows.push_back(table_row("nRMSE, second half", figures.normalised_error_second_half));
    table.rows.push_back(table_row("share within 2σ", figures.within_two_deviations));
    if (summary.horizon > 0) {
        table.rows.push_back(table_row("ε, median of the first 30 s", figures.horizon_transient));
        table.rows.push_back(table_row("ε, median after 30 s", figures.horizon_steady));
    }
    return table;
}

std::vector<ReportFact> facts_of(const TrainedModel& model, const ReplaySummary& summary) {
    const auto trained_on = std::accumulate(
        model.training.recordings.begin(), model.training.recordings.end(), std::string(),
        [](const std::string& all, const std::string& one) { return all.empty() ? one : all + ", " + one; });
    return {{"Model", summary.model},
            {"Trained on", trained_on + ", rows " + model.training.rows},
            {"Time per tick, median", formatted_or_dash("%.1f µs", summary.median_us)},
            {"Time per tick, 99 %", formatted_or_dash("%.1f µs", summary.p99_us)},
            {"Time per tick, longest", formatted_or_dash("%.1f µs", summary.longest_us)},
            {"Multiply-adds per tick", std::to_string(summary.operations)},
            {"Learned state", std::to_string(summary.state_bytes) + " bytes"},
            {"Build", build_flags()}};
}

ReportInnovation innovation_of(const TrainedModel& model, std::span<const ReplayedRecording> replayed) {
    ReportInnovation innovation{{}, model.limits.innovation, "limit of learning"};
    for (const ReplayedRecording& recording : replayed) {
        innovation.normalised_squared.insert(innovation.normalised_squared.end(),
                                             recording.normalised_innovation_squared.begin(),
                                             recording.normalised_innovation_squared.end());
    }
    return innovation;
}

/// Returns sentences like "17154 ticks, every prediction made before its sample was learned. The measurement
/// contradicts the model in 4 stretches."
std::string summary_sentence(const ReplaySummary& summary) {
    std::size_t ticks = 0;
    std::size_t forgotten = 0;
    std::size_t predicted = 0;
    std::size_t stretches = 0;
    for (const RecordingFigures& figures : summary.recordings) {
        ticks += figures.ticks;
        forgotten += figures.forgotten;
        predicted += figures.predicted;
        stretches += figures.contradictions.size();
    }
    if (predicted == 0) {
        return std::to_string(ticks) + " ticks, nothing was predicted.";
    }
    const std::string part =
        forgotten == 0 ? "" : "The figures are of the last " + std::to_string(ticks - forgotten) + " ticks. ";
    const std::string learning =
        std::to_string(ticks) + (summary.learned
                                     ? " ticks, every prediction made before its sample was learned. "
                                     : " ticks, predicted without learning. ");
    return learning + part +
           (stretches == 0 ? "The measurement does not contradict the model anywhere."
                           : "The measurement contradicts the model in " + std::to_string(stretches) +
                                 (stretches == 1 ? " stretch." : " stretches."));
}

} // namespace

Report make_replay_report(const TrainedModel& model, std::span<const ReplayedRecording> replayed,
                          const ReplaySummary& summary) {
    Report report;
    report.title = replayed.size() > 1 ? "Replay of " + std::to_string(replayed.size()) + " recordings"
                                       : "Replay of " + summary.recordings.front().name;
    report.summary = summary_sentence(summary);
    for (const RecordingFigures& figures : summary.recordings) {
        report.tables.push_back(table_of(figures, summary));
    }
    report.tables.back().note =
        "nRMSE = rms(measured − predicted) / std(measured). ε: squared error over the next T = " +
        std::to_string(summary.horizon) +
        " samples, predicted by the model as it was before them, relative to the squared output.";
    report.facts = facts_of(model, summary);
    add_times(replayed, summary, report);
    const std::vector<std::string> units = output_units(model);
    for (std::size_t k = 0; k < units.size(); ++k) {
        report.series.push_back({summary.outputs[k], units[k], {}, {}, {}});
        add_values(replayed, k, units.size(), report.series.back());
    }
    report.innovation = innovation_of(model, replayed);
    return report;
}

} // namespace dfdyn::tools
