// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay_summary.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/number.hpp"
#include "tools/build_flags.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/replay/opponents/rigid_body.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>

namespace dfdyn::tools {

namespace {

std::vector<std::pair<std::string, std::size_t>> refusals_of(const ReplayTotals& totals) {
    std::vector<std::pair<std::string, std::size_t>> refusals(totals.reasons.begin(), totals.reasons.end());
    std::erase_if(refusals, [](const auto& entry) { return entry.first == name(Reason::ok); });
    return refusals;
}

RecordingFigures figures_of(const ReplayedRecording& replayed, const TrainedModel& model) {
    const std::size_t outputs = model.outputs.names.size();
    const std::size_t ticks = replayed.time_s.size();
    RecordingFigures figures;
    figures.name = std::filesystem::path(replayed.source).filename().string();
    figures.ticks = replayed.totals.ticks;
    figures.forgotten = replayed.forgotten;
    figures.predicted = replayed.totals.predicted;
    figures.learned = replayed.totals.learned;
    figures.refusals = refusals_of(replayed.totals);
    for (std::size_t k = 0; k < outputs; ++k) {
        figures.normalised_error.push_back(normalised_error(replayed, outputs, k, 0, ticks));
        figures.normalised_error_second_half.push_back(
            normalised_error(replayed, outputs, k, ticks / 2, ticks));
        figures.within_two_deviations.push_back(share_within_two_deviations(replayed, outputs, k));
        figures.horizon_transient.push_back(replayed.forgotten > 0
                                                ? std::numeric_limits<double>::quiet_NaN() // it is incomplete
                                                : median_horizon_index(replayed, k, 0, transient_s));
        figures.horizon_steady.push_back(
            median_horizon_index(replayed, k, transient_s, std::numeric_limits<double>::infinity()));
    }
    figures.opponents = opponent_errors(replayed, model);
    figures.contradictions = find_contradictions(replayed, model.limits.innovation);
    return figures;
}

std::string describe_model(const TrainedModel& model) {
    const InputModel& input = model.input;
    return model.structure + ", input " + input_description(input.kind).name + " (" +
           std::to_string(input.lags) + " lags, " + std::to_string(input.rows_per_joint) +
           " features per joint), " + std::to_string(2 * model.features.count) + " random " +
           (model.features.orthogonal ? "orthogonal " : "") + "Fourier columns";
}

/// Durations of the ticks with learning, or otherwise of those with a prediction (µs).
std::vector<double> durations_of(std::span<const ReplayedRecording> replayed, bool learned) {
    std::vector<double> durations;
    for (const ReplayedRecording& recording : replayed) {
        for (std::size_t tick = 0; tick < recording.status.size(); ++tick) {
            const Status& status = recording.status[tick];
            if (learned ? status.learned() : status.estimated()) {
                durations.push_back(recording.duration_us[tick]);
            }
        }
    }
    return durations;
}

/// Returns the reason why no recording was compared with a rigid body; empty if one was.
std::string reason_without_rigid_body(std::span<const TrainedModel> models,
                                      std::span<const ReplayedRecording> replayed) {
    if (std::ranges::any_of(replayed, [](const ReplayedRecording& one) { return !one.rigid_body.empty(); })) {
        return "";
    }
    return rigid_body_of(models) == nullptr
               ? "no model has one: dfdyn train fits it for models with --robot (P, SP, SP2, SPK)"
               : "only CSV recordings are compared with it";
}

void print_line(std::ostream& out, const std::string& label, std::span<const std::string> cells) {
    out << "  " << label << std::string(label.size() < 26 ? 26 - label.size() : 1, ' ');
    for (const std::string& cell : cells) {
        out << std::string(cell.size() < 8 ? 8 - cell.size() : 1, ' ') << cell;
    }
    out << '\n';
}

void print_values(std::ostream& out, const std::string& label, const std::vector<double>& values) {
    std::vector<std::string> cells;
    for (const double value : values) {
        cells.push_back(formatted_or_dash("%.3f", value));
    }
    print_line(out, label, cells);
}

nlohmann::ordered_json recording_json(const RecordingFigures& figures) {
    nlohmann::ordered_json json{{"name", figures.name},
                                {"ticks", figures.ticks},
                                {"predicted", figures.predicted},
                                {"learned", figures.learned},
                                {"forgotten", figures.forgotten},
                                {"refused", nlohmann::ordered_json::object()},
                                {"nrmse", figures.normalised_error},
                                {"nrmse_second_half", figures.normalised_error_second_half},
                                {"within_two_deviations", figures.within_two_deviations},
                                {"others", nlohmann::ordered_json::array()},
                                {"contradictions", nlohmann::ordered_json::array()}};
    for (const auto& [reason, count] : figures.refusals) {
        json["refused"][reason] = count;
    }
    for (const OpponentErrors& other : figures.opponents) {
        json["others"].push_back({{"name", other.label}, {"nrmse", other.normalised_error}});
    }
    for (const Contradiction& one : figures.contradictions) {
        json["contradictions"].push_back(
            {{"start_s", one.start_s}, {"end_s", one.end_s}, {"peak_nis", one.peak}});
    }
    return json;
}

} // namespace

ReplaySummary summarise(std::span<const TrainedModel> models, const RuntimeEstimator& estimator,
                        std::span<const ReplayedRecording> replayed, std::size_t horizon) {
    ReplaySummary summary;
    summary.outputs = models.front().outputs.names;
    summary.horizon = horizon;
    for (const TrainedModel& model : models) {
        summary.model += (summary.model.empty() ? "" : "; ") + describe_model(model);
    }
    summary.state_bytes = estimator.state_bytes();
    for (const ReplayedRecording& recording : replayed) {
        summary.recordings.push_back(figures_of(recording, models.front()));
        summary.learned = summary.learned || summary.recordings.back().learned > 0;
    }
    const Cost cost = estimator.cost(); // learning provides the variance
    summary.operations = cost.predict + (summary.learned ? cost.learn : cost.variance);
    summary.no_rigid_body = reason_without_rigid_body(models, replayed);
    std::vector<double> durations = durations_of(replayed, summary.learned);
    if (durations.empty()) { // ticks with learning exist, but none among those kept
        durations = durations_of(replayed, false);
    }
    if (!durations.empty()) {
        summary.median_us = median(durations);
        summary.p99_us = quantile(durations, 0.99);
        summary.longest_us = quantile(durations, 1);
    }
    return summary;
}

void print_summary(std::ostream& out, const ReplaySummary& summary) {
    out << "model: " << summary.model << '\n';
    for (const RecordingFigures& recording : summary.recordings) {
        out << recording.name << ": " << recording.ticks << " ticks, " << recording.predicted
            << " predicted, " << recording.learned << " learned\n";
        for (const auto& [reason, count] : recording.refusals) {
            out << "  " << count << " x " << reason << '\n';
        }
        if (recording.forgotten > 0) {
            out << "  the figures below are of the last " << recording.ticks - recording.forgotten
                << " ticks\n";
        }
        print_line(out, "", summary.outputs);
        print_values(out, "nRMSE, one step", recording.normalised_error);
        for (const OpponentErrors& opponent : recording.opponents) {
            print_values(out, "  " + opponent.label, opponent.normalised_error);
        }
        print_values(out, "nRMSE, second half", recording.normalised_error_second_half);
        print_values(out, "share within 2 sigma", recording.within_two_deviations);
        for (const Contradiction& contradiction : recording.contradictions) {
            out << "  contradicts the model from " << formatted("%.2f", contradiction.start_s) << " to "
                << formatted("%.2f", contradiction.end_s) << " s (nis up to "
                << formatted("%.0f", contradiction.peak) << ")\n";
        }
        if (summary.horizon > 0) {
            const std::string index = "epsilon (T=" + std::to_string(summary.horizon) + ")";
            print_values(out, index + ", first 30 s", recording.horizon_transient);
            print_values(out, index + ", after", recording.horizon_steady);
        }
    }
    if (!summary.no_rigid_body.empty()) {
        out << "rigid body: -: " << summary.no_rigid_body << '\n';
    }
    out << "time of a tick that " << (summary.learned ? "learns" : "predicts") << ", on this machine: median "
        << formatted_or_dash("%.1f us", summary.median_us) << ", 99 % "
        << formatted_or_dash("%.1f us", summary.p99_us) << ", longest "
        << formatted_or_dash("%.1f us", summary.longest_us) << " (" << summary.operations
        << " multiply-adds)\n"
        << "learned state: " << summary.state_bytes << " bytes\n"
        << "build: " << build_flags() << '\n';
}

nlohmann::ordered_json replay_json(const ReplaySummary& summary) {
    nlohmann::ordered_json json{
        {"schema", "dfdyn.replay/1"},
        {"model", summary.model},
        {"outputs", summary.outputs},
        {"recordings", nlohmann::ordered_json::array()},
        {"state_bytes", summary.state_bytes},
        {"tick_operations", summary.operations},
        {"tick_us",
         {{"median", summary.median_us}, {"p99", summary.p99_us}, {"longest", summary.longest_us}}}};
    for (const RecordingFigures& figures : summary.recordings) {
        json["recordings"].push_back(recording_json(figures));
    }
    return json;
}

} // namespace dfdyn::tools
