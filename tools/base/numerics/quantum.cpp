// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/quantum.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dfdyn::tools {

std::optional<double> quantum_of(std::vector<double> values) {
    constexpr std::size_t fewest_steps = 5;
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
        return std::abs(step - quantum * std::round(step / quantum)) < 0.02 * quantum;
    });
    return multiples && steps.size() >= fewest_steps ? std::optional(quantum) : std::nullopt;
}

} // namespace dfdyn::tools
