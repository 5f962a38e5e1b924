// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/replay/contradiction.hpp"
#include "tools/replay/opponents/opponents.hpp"

#include <nlohmann/json_fwd.hpp>

#include <limits>
#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Statistics of one recording; one value per output, NaN if there is no data.
struct RecordingFigures {
    std::string name; ///< file name without folders
    std::size_t ticks = 0, predicted = 0, learned = 0;
    std::size_t forgotten = 0; ///< ticks that are included above but not in the statistics below
    std::vector<std::pair<std::string, std::size_t>> refusals; ///< reasons other than ok, and their numbers
    std::vector<double> within_two_deviations;                 ///< share of ticks
    std::vector<double> normalised_error;                      ///< one-step nRMSE over all ticks
    std::vector<OpponentErrors> opponents;                     ///< over the same ticks
    std::vector<double> normalised_error_second_half; ///< over the second half of the recording's ticks
    std::vector<double> horizon_transient; ///< median of ε over the first 30 s; NaN if ticks are forgotten
    std::vector<double> horizon_steady;    ///< median of ε after that
    std::vector<Contradiction> contradictions;
};

struct ReplaySummary {
    std::vector<std::string> outputs;
    std::vector<RecordingFigures> recordings;
    std::size_t horizon = 0;
    std::string model;         ///< one line: structure, input and features of each combined model
    std::string no_rigid_body; ///< reason for the missing rigid body to compare with; empty: there is one
    std::size_t state_bytes = 0;
    /// multiply-adds of a tick that learns, or of one that predicts with its variance if there was no
    /// learning
    std::int64_t operations = 0;
    bool learned = false; ///< whether any tick had learning
    /// of ticks with learning, or of those with a prediction if there was no learning; NaN: there are none
    double median_us = std::numeric_limits<double>::quiet_NaN(), p99_us = median_us, longest_us = median_us;
};

/// Time after which the paper considers a model converged.
inline constexpr double transient_s = 30;

/// Computes the statistics of a replay; `models`: those of `estimator`.
ReplaySummary summarise(std::span<const TrainedModel> models, const RuntimeEstimator& estimator,
                        std::span<const ReplayedRecording> replayed, std::size_t horizon);

/// Prints them as tables, with the compiler's flags next to the times.
void print_summary(std::ostream& out, const ReplaySummary& summary);

/// Returns the statistics of a replay, schema `dfdyn.replay/1`; values without data are null.
nlohmann::ordered_json replay_json(const ReplaySummary& summary);

} // namespace dfdyn::tools
