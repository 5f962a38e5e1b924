// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/training_options.hpp"

#include <CLI/CLI.hpp>

#include <optional>
#include <string>

namespace dfdyn::tools {

/// The options of `train` for windows and memories, in seconds or in samples.
struct ClockOptions {
    /// Default window (s).
    static constexpr double default_window_s = 0.08;

    std::optional<int> lags;
    std::optional<int> every;
    std::optional<double> window_s;
    std::optional<double> memory_s;
    std::optional<double> forgetting_factor;

    void add_to(CLI::App& command);

    /// Sets lags, their spacing and the forgetting factor for recordings with this sample period. Input and
    /// method must be set before, because input STD and cross validation require lags one sample apart.
    /// The model must be set, and the number of features unless `free_features`: a budget chooses it later.
    /// Throws InputError for a window of more than 1000 samples, and for `memory_s` of fewer samples than the
    /// features have columns (2 samples without features). With `free_features`, these are the columns of
    /// least_feature_count features.
    void apply(TrainingOptions& training, double period_s, bool free_features = false) const;
};

/// Returns text like "sample period 0.001 s, window 0.08 s (20 lags, 4 samples apart), memory unlimited". If
/// single precision changes the memory by more than a hundredth, the text has that of the model and the given
/// one.
std::string describe_clock(const TrainingOptions& training, double period_s);

} // namespace dfdyn::tools
