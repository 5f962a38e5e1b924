// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

namespace dfdyn::tools {

/// Progress of the training: reported after every evaluation of the likelihood or every point of the grid,
/// and once when the batch solution begins.
struct TrainingProgress {
    bool searching = true; ///< false: the hyperparameters are determined, and the initial state is computed
    int evaluations = 0;   ///< so far, over all starts and the refinement
    int evaluations_most = 0; ///< if no search ends early
    /// Present only in the call that reports the end of a start.
    struct End {
        int start = 0;
        std::optional<double> log_likelihood; ///< empty: the start failed, no point had a finite likelihood
    };
    std::optional<End> end;
};

/// May be empty. Called from the worker threads, one call at a time.
using ProgressCallback = std::function<void(const TrainingProgress&)>;

} // namespace dfdyn::tools
