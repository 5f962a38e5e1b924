// SPDX-License-Identifier: Apache-2.0
// The embedding example in double precision; the model's constants are converted at compile time.
#include "embedding.hpp"

#include "ur5_model.hpp"
#include "ur5_ticks.hpp"

#include <algorithm>

namespace {

using Single = ur5_model::Model;
using Model = dfdyn::Model<double, Single::Arm, Single::Input, Single::Features>;
using Estimator = dfdyn::Estimator<Model>;

template <int count>
constexpr dfdyn::Storage<double, count> widened(const dfdyn::Storage<float, count>& values) {
    dfdyn::Storage<double, count> wide{};
    std::ranges::copy(values, wide.begin());
    return wide;
}

constexpr dfdyn::LearnerStart<double, Model::columns, Model::outputs> start{
    .weights = widened(ur5_model::start.weights),
    .unit_upper = widened(ur5_model::start.unit_upper),
    .diagonal = widened(ur5_model::start.diagonal)};

constexpr Model::Constants widened(const Single::Constants& model) {
    return {.sizes = {},
            .identity = model.identity,
            .gap_ns = model.gap_ns,
            .period_ns = model.period_ns,
            .input = {widened(model.input.rows), widened(model.input.scale)},
            .features = {widened(model.features.frequencies), static_cast<double>(model.features.amplitude)},
            .physics = {},
            .output_offset = widened(model.output_offset),
            .output_noise_std = widened(model.output_noise_std),
            .position_limit = widened(model.position_limit),
            .output_limit = widened(model.output_limit),
            .innovation_limit = static_cast<double>(model.innovation_limit),
            .innovation_patience = model.innovation_patience,
            .prediction_limit = widened(model.prediction_limit),
            .learner = {static_cast<double>(model.learner.prior_variance),
                        static_cast<double>(model.learner.forgetting_factor), &start},
            .extrapolation = {static_cast<double>(model.extrapolation.inverse_far_variance),
                              widened(model.extrapolation.extra_noise),
                              widened(model.extrapolation.prior_variance),
                              static_cast<double>(model.extrapolation.parameter_variance_factor),
                              widened(model.extrapolation.output_variance)}};
}

constexpr Model::Constants constants = widened(ur5_model::constants);
Estimator estimator(constants);

} // namespace

int run_example_in_double(void (*after_tick)(const TickOutcome&)) {
    estimator.reset();
    for (const Ur5Sample& recorded : ur5_samples) {
        const auto estimate =
            estimator.tick(read_sensors<Estimator::Sample>(recorded), dfdyn::Budget::unlimited());
        if (after_tick != nullptr) {
            after_tick(outcome_of(estimate));
        }
    }
    return estimator.counters().learned > 200 ? 0 : 1;
}
