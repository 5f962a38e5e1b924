// SPDX-License-Identifier: Apache-2.0
#include "tools/training/sign_velocity.hpp"

#include "tools/model/structure.hpp"
#include "tools/training/data/lag_spacing.hpp"
#include "tools/training/search/fit.hpp"
#include "tools/training/search/training_setup.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace dfdyn::tools {
namespace {

constexpr std::array candidates{usual_sign_velocity, 0.1, 0.02, 0.01, 0.005, 0.002};

/// Returns the options of a quick training of the physics alone, which has nothing to learn from the input.
TrainingOptions quick_options(TrainingOptions options) {
    options.model = &structures::P;
    options.physics.given.reset();
    options.input = InputKind::DFSR; // with the fewest parameters
    options.likelihood_rows = std::min(options.likelihood_rows, 400);
    options.starts = 1;
    options.evaluations_per_start = std::min(options.evaluations_per_start, 60);
    options.refinement_evaluations = 0;
    return options;
}

} // namespace

double most_likely_sign_velocity(
    const TrainingData& data, const TrainingOptions& options,
    const std::function<std::unique_ptr<Regressor>(double sign_velocity)>& regressor_at) {
    const TrainingData spaced = spaced_data(data, options.every);
    TrainingOptions quick = quick_options(options);
    std::unique_ptr<Regressor> regressor = regressor_at(usual_sign_velocity);
    quick.physics.regressor = regressor.get();
    check_options(quick, data);
    check_training_data(data, quick.input);
    const TrainingSetup setup(spaced, quick); // reads the regressor of `quick` anew in every fit
    check_outputs_vary(setup);
    double best = usual_sign_velocity;
    double most = -std::numeric_limits<double>::infinity();
    for (const double candidate : candidates) {
        regressor = regressor_at(candidate);
        quick.physics.regressor = regressor.get();
        const double log_likelihood = fit_by_likelihood(setup, {}).record.log_likelihood;
        if (log_likelihood > most) {
            most = log_likelihood;
            best = candidate;
        }
    }
    return best;
}

} // namespace dfdyn::tools
