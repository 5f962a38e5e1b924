// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/replay/contradiction.hpp"
#include "tools/replay/opponents/opponents.hpp"

#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The figures of one recording; one value per output, NaN where there is nothing to average.
struct RecordingFigures {
    std::string name; ///< file name without folders
    std::size_t ticks = 0, predicted = 0, learned = 0;
    std::size_t forgotten = 0; ///< ticks that count above, and in none of the figures below
    std::vector<std::pair<std::string, std::size_t>> refusals; ///< reasons other than ok, and how often
    std::vector<double> within_two_deviations;                 ///< share of ticks
    std::vector<double> normalised_error;                      ///< one-step nRMSE over all ticks
    std::vector<OpponentErrors> opponents;                     ///< at the same ticks
    std::vector<double> normalised_error_second_half; ///< over the second half of the recording's ticks
    std::vector<double> horizon_transient;            ///< median of ε over the first 30 s
    std::vector<double> horizon_steady;               ///< median of ε after that
    std::vector<Contradiction> contradictions;
};

struct ReplaySummary {
    std::vector<std::string> outputs;
    std::vector<RecordingFigures> recordings;
    std::size_t horizon = 0;
    std::string model;         ///< one line: structure, input, features, of each that is combined
    std::string no_rigid_body; ///< why there is no rigid body to compare with; empty: there is one
    std::size_t state_bytes = 0;
    std::int64_t operations = 0; ///< multiply-adds per tick that learns; if none did, per tick
    bool learned = false;        ///< whether any tick learned
    double median_us = 0, p99_us = 0, longest_us = 0; ///< of ticks that learned; if none did, that predicted
};

/// The time after which the paper takes a model to have settled.
inline constexpr double transient_s = 30;

/// Gathers the figures of a replay; `models`: those that `estimator` was made of.
ReplaySummary summarise(std::span<const TrainedModel> models, const HostEstimator& estimator,
                        std::span<const ReplayedRecording> replayed, std::size_t horizon);

/// Writes them as tables, with the compiler's flags beside the times.
void print_summary(std::ostream& out, const ReplaySummary& summary);

} // namespace dfdyn::tools
