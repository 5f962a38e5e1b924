// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/train.hpp"

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
    /// Throws InputError for a window of more than 1000 samples and for a memory shorter than a sample
    /// period.
    void apply(TrainingOptions& training, double period_s) const;
};

/// Returns text like "sample period 0.001 s, window 0.08 s (20 lags, 4 samples apart), memory unlimited".
std::string describe_clock(const TrainingOptions& training, double period_s);

} // namespace dfdyn::tools
