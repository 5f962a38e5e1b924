// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/control/feed_forward.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace dfdyn::tests::scripted {

inline constexpr std::int64_t period_ns = 2'000'000;
inline constexpr double period_s = 2e-3;
inline constexpr int ticks_per_sample = 4;

/// A learner whose predictions the test sets, and which records its calls.
struct ScriptedLearner {
    using Scalar = double;
    static constexpr int outputs = 1;
    static constexpr int forecasts = 1;
    [[nodiscard]] static constexpr Extent<1> forecast_count() noexcept { return {}; }

    [[nodiscard]] static constexpr Extent<1> output_count() noexcept { return {}; }
    void begin(std::int64_t /*time_ns*/, const double* position) { began_at = *position; }
    void learn(std::int64_t time_ns, const double* /*position*/, const double* torque) {
        learned.push_back(time_ns);
        last_torque = torque != nullptr ? *torque : std::numeric_limits<double>::quiet_NaN();
    }
    void go_on() { ++went_on; }
    bool predict(std::int64_t time_ns, const double* position, double* torque) {
        predicted.push_back(time_ns);
        asked_at.push_back(*position);
        *torque = knows ? forecast : 0;
        return knows;
    }

    double forecast = 0;
    bool knows = true;
    double began_at = -1, last_torque = 0;
    int went_on = 0;
    std::vector<std::int64_t> learned, predicted;
    std::vector<double> asked_at;
};

using Forward = FeedForward<ScriptedLearner>;
inline const Forward::Settings settings{period_ns, ticks_per_sample, {{100}}, {{60}}, {{2000}}};

} // namespace dfdyn::tests::scripted
