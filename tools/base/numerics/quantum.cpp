// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/quantum.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dfdyn::tools {

namespace {

constexpr double quantum_tolerance = 0.02; // of the quantum

/// Returns whether nearly all steps from a value to the next have the size of the quantum. Equal values in a
/// row count as one, as before a motion and after it. A quantised signal also repeats and skips values.
bool constant_speed(const std::vector<double>& values, double quantum) {
    constexpr double nearly_all = 0.95;
    double steps = 0;
    double single = 0;
    bool resting = true;
    for (std::size_t i = 1; i < values.size(); ++i) {
        const double step = std::abs(values[i] - values[i - 1]);
        const bool rests = step < quantum_tolerance * quantum;
        steps += rests && resting ? 0 : 1;
        single += std::abs(step - quantum) < quantum_tolerance * quantum ? 1 : 0;
        resting = rests;
    }
    return single > nearly_all * steps;
}

} // namespace

std::optional<double> quantum_of(const std::vector<double>& signal) {
    constexpr std::size_t fewest_steps = 5;
    std::vector<double> values = signal;
    std::ranges::sort(values);
    double quantum = values.empty() ? 0 : values.back() - values.front();
    const double rounding = 1e-6 * quantum;
    std::vector<double> steps;
    for (std::size_t i = 1; i < values.size(); ++i) {
        if (const double step = values[i] - values[i - 1]; step > rounding) {
            steps.push_back(step);
            quantum = std::min(quantum, step);
        }
    }
    const bool multiples = std::ranges::all_of(steps, [&](double step) {
        return std::abs(step - quantum * std::round(step / quantum)) < quantum_tolerance * quantum;
    });
    const bool quantised = multiples && steps.size() >= fewest_steps && !constant_speed(signal, quantum);
    return quantised ? std::optional(quantum) : std::nullopt;
}

} // namespace dfdyn::tools
