// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay_json.hpp"

#include <nlohmann/json.hpp>

namespace dfdyn::tools {
namespace {

nlohmann::ordered_json recording_json(const RecordingFigures& figures) {
    nlohmann::ordered_json json{{"name", figures.name},
                                {"ticks", figures.ticks},
                                {"predicted", figures.predicted},
                                {"learned", figures.learned},
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
