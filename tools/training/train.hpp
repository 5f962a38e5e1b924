// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/training_data.hpp"

#include <cstdint>
#include <functional>
#include <optional>

namespace dfdyn::tools {

/// How to train; the values here are the defaults.
struct TrainingOptions {
    InputKind input = InputKind::DFR;
    int lags = 10;                   ///< M >= 1 (DFSR: >= 2); STD: the longest window minus one
    int rows_per_joint = 3;          ///< k of DFR, 1 … M+1; the other inputs have their own
    int feature_count = 250;         ///< d >= 1
    bool orthogonal = true;          ///< orthogonal random features
    int likelihood_rows = 1000;      ///< samples in the exact kernel, at most; >= 20; time goes with the cube
    int starts = 6;                  ///< local searches, >= 1
    int evaluations_per_start = 200; ///< at most, >= 1
    int refinement_evaluations = 40; ///< at most, by FeatureLikelihood over all rows; 0: no refinement
    int threads = 2;                 ///< >= 1; does not change the result
    std::uint64_t seed = 1;          ///< of the starts and of omega
    double forgetting_factor = 1;    ///< of the learner, in [1 - 1/(2d), 1]
    double position_noise_bound = 0; ///< STD only, copied into the model
};

/// How far training is: after every evaluation of the likelihood.
struct TrainingProgress {
    int evaluations = 0;      ///< so far, of all starts
    int evaluations_most = 0; ///< if no start ends early
    /// Only in the call that reports a start's end.
    struct End {
        int start = 0;
        std::optional<double> log_likelihood; ///< nothing: the start failed, no point had a finite likelihood
    };
    std::optional<End> end;
};

/// May be empty. Called from the working threads, one call at a time.
using ProgressCallback = std::function<void(const TrainingProgress&)>;

/// Trains model NP: hyperparameters by marginal likelihood of the exact kernel on strided rows in motion,
/// refined by that of the random features on all usable rows (see FeatureLikelihood), then the batch solution
/// over these rows as the start. Outputs are centred at their mean over the rows in motion; a plausible
/// position is at most ten times the largest magnitude seen (at least 2 pi), an output ten times its largest.
/// The same data, options and program give the same model bit for bit, whatever the number of threads.
/// `training.recordings` and `training.rows` are left to the caller. `training.all_starts` holds the starts
/// that did not fail, in their order. Throws InputError for options out of range, data as
/// check_training_data() says, fewer than 20 usable rows in motion, a constant output, or when every start
/// fails. Cost: starts * evaluations * O(likelihood_rows^3), then O(T (2d)^2 + (2d)^3).
TrainedModel train(const TrainingData& data, const TrainingOptions& options,
                   const ProgressCallback& progress = {});

} // namespace dfdyn::tools
