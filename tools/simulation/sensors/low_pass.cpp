// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/sensors/low_pass.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

LowPass::LowPass(int order, double bandwidth_hz, double period_s) noexcept {
    const double k = std::tan(std::numbers::pi * bandwidth_hz * period_s); // prewarped
    if (order == 1) {
        const double scale = 1 / (1 + k);
        input_[0] = input_[1] = k * scale;
        input_[2] = 0;
        output_[0] = (k - 1) * scale;
        output_[1] = 0;
        return;
    }
    const double scale = 1 / (1 + std::numbers::sqrt2 * k + k * k);
    input_[0] = input_[2] = k * k * scale;
    input_[1] = 2 * input_[0];
    output_[0] = 2 * (k * k - 1) * scale;
    output_[1] = (1 - std::numbers::sqrt2 * k + k * k) * scale;
}

Wrench LowPass::filter(const Wrench& input) noexcept {
    if (!started_) {
        past_input_[0] = past_input_[1] = past_output_[0] = past_output_[1] = input;
        started_ = true;
    }
    Wrench output = input_[0] * input + input_[1] * past_input_[0] + input_[2] * past_input_[1] -
                    output_[0] * past_output_[0] - output_[1] * past_output_[1];
    past_input_[1] = past_input_[0];
    past_input_[0] = input;
    past_output_[1] = past_output_[0];
    past_output_[0] = output;
    return output;
}

} // namespace dfdyn::tools
