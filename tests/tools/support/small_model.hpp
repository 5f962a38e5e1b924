// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <random>

namespace dfdyn::tests {

/// A model of two joints and a wrench with random content that is valid throughout; 2d = 6 columns.
inline tools::TrainedModel small_model(std::mt19937_64& engine, tools::InputKind kind) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> positive(0.5, 2);
    const auto numbers = [&](std::size_t count, auto& distribution) {
        std::vector<double> values(count);
        for (double& value : values) {
            value = distribution(engine);
        }
        return values;
    };
    const bool full = kind == tools::InputKind::DF || kind == tools::InputKind::DFW;
    tools::TrainedModel model;
    model.joints = 2;
    model.sample_period_s = 0.004;
    model.forgetting_factor = 0.999;
    model.input = {kind, 4, full ? 5 : 3, {}, {}, {}, {}, 0};
    const auto rows = static_cast<std::size_t>(model.input.rows_per_joint);
    model.input.scale = numbers(2 * rows, positive);
    if (kind == tools::InputKind::STD) {
        model.input.position_noise_bound = 1e-3;
    } else {
        model.input.rows = numbers(rows * 5, normal);
    }
    if (kind == tools::InputKind::DFSR) {
        model.input.alpha = {250, 62500};
        model.input.beta = {0.5, 0.7};
    }
    model.features = {true, 3, 7, numbers(3 * 2 * rows, normal), 1.5};
    model.outputs = {{"fx", "fy", "fz", "mx", "my", "mz"}, numbers(6, normal), numbers(6, positive), 100};
    model.limits = {{10, 10}, {100, 100, 100, 100, 100, 100}, 1e6, 250};
    model.start = {numbers(36, normal), numbers(15, normal), numbers(6, positive)};
    model.training = {{"run.csv"}, "0:100", "ML", 7, 100, -12.5, {-12.5, -13}};
    return model;
}

} // namespace dfdyn::tests
