// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/train_case.hpp"

#include "tools/common/error.hpp"
#include "tools/training/random_features.hpp"
#include "tools/training/recorded_data.hpp"
#include "tools/training/row_selection.hpp"
#include "tools/training/start_state.hpp"
#include "tools/training/train.hpp"

#include <limits>
#include <span>

namespace dfdyn::tools {

namespace {

/// Of the starts of the searches: the same for all draws, so that it does not matter which comes first.
constexpr std::uint64_t search_seed = 1;

void check_available(const Case& one) {
    if (one.model != "NP" || one.hyper != "ML") {
        throw InputError("not available: expected model NP tuned by ML, found " + one.model + " by " +
                         one.hyper);
    }
}

TrainingOptions options_of(const Case& one) {
    TrainingOptions options;
    options.input = one.input;
    options.lags = one.lags;
    options.rows_per_joint = one.rows_per_joint;
    options.feature_count = one.feature_count;
    options.orthogonal = one.orthogonal;
    options.forgetting_factor = one.forgetting_factor;
    options.likelihood_rows = one.likelihood_rows;
    options.starts = one.starts;
    options.refinement_evaluations = 0; // it would depend on the draw
    options.seed = search_seed;
    return options;
}

TrainedModel tune(const TrainingData& data, TrainingOptions options,
                  const std::function<void(double)>& progress) {
    return train(data, options, [&progress](const TrainingProgress& done) {
        progress(static_cast<double>(done.evaluations) / static_cast<double>(done.evaluations_most));
    });
}

/// The tuned model with other random features, and the start that belongs to them.
TrainedModel redraw(TrainedModel model, const TrainingData& data, std::uint64_t seed) {
    model.features = draw_features(model.features.count, model.joints * model.input.rows_per_joint,
                                   model.features.orthogonal, model.features.length_scale, seed);
    model.start = batch_start(model, data, usable_rows(data.gap_before, model.input.lags));
    return model;
}

} // namespace

TrainedModel train_case(const Case& one, const CaseContext& context, std::uint64_t seed, CaseMemory& memory,
                        const std::function<void(double)>& progress) {
    check_available(one);
    const std::span<const Recording> recordings(&context.start, 1);
    TrainingOptions options = options_of(one);
    TrainingData data = gather_training_data(recordings);
    if (one.input == InputKind::STD) {
        options.position_noise_bound = estimate_position_noise_bound(data);
        estimate_derivatives(data, recordings, options.lags, options.position_noise_bound);
    }
    {
        const std::lock_guard lock(memory.tuning);
        if (!memory.tuned) {
            memory.tuned = tune(data, options, progress);
            memory.tuned->limits.innovation = static_cast<double>(std::numeric_limits<float>::max());
        }
    }
    return redraw(*memory.tuned, data, seed);
}

} // namespace dfdyn::tools
