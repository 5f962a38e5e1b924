// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sizing/model_needs.hpp"

#include <cstddef>
#include <string>

namespace dfdyn::tests {

/// A model whose numbers are arbitrary; only its sizes matter.
inline tools::TrainedModel sized_model(int joints, int outputs, int lags, int rows, int features) {
    tools::TrainedModel model;
    model.joints = joints;
    model.sample_period_s = 0.001;
    model.input.lags = lags;
    model.input.rows_per_joint = rows;
    model.input.rows.assign(static_cast<std::size_t>(rows * (lags + 1)), 1);
    model.input.scale.assign(static_cast<std::size_t>(rows * joints), 1);
    model.features.length_scale = 1;
    const auto count = static_cast<std::size_t>(outputs);
    for (std::size_t k = 1; k <= count; ++k) {
        model.outputs.names.push_back("tau" + std::to_string(k));
    }
    model.outputs.offset.assign(count, 0);
    model.outputs.noise_std.assign(count, 1);
    model.limits.position_rad.assign(static_cast<std::size_t>(joints), 7);
    model.limits.output.assign(count, 100);
    model.limits.innovation = 100;
    return tools::with_feature_count(model, features);
}

} // namespace dfdyn::tests
