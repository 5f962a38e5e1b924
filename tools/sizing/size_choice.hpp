// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sizing/model_needs.hpp"
#include "tools/training/model_training.hpp"

#include <functional>
#include <optional>
#include <ostream>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// What the choice may set; the other settings are the caller's.
struct FreeSizes {
    bool window = true;   ///< M and the spacing of lags
    bool rows = true;     ///< k of input DFR
    bool features = true; ///< d
    bool memory = true;   ///< the forgetting factor
};

/// One set of sizes that was tried.
struct SizeCandidate {
    TrainingOptions options;
    double window_s = 0;
    double memory_s = 0; ///< 0: nothing is forgotten
    ModelNeeds needs;
    double error = 0; ///< held-out: mean over the outputs of nRMSE
};

struct SizeChoice {
    SizeCandidate chosen;
    std::optional<SizeCandidate> smaller,
        larger;    ///< the next numbers of features; larger may exceed the budget
    int tried = 0; ///< models that were trained
};

/// Chooses sizes within `budget` by a coordinate search: window, rows per joint, memory, features. Each
/// candidate is trained on the first 70 % of the rows, with few starts and likelihood rows, and judged on the
/// rest, one step ahead, learning on. Of candidates whose errors are within 1 %, the one that needs fewer
/// operations is chosen. The same data give the same choice. `on_candidate` is called before each training.
/// Throws InputError if nothing fits the budget, and as train_model(). Cost: about ten trainings.
SizeChoice choose_sizes(std::span<const Recording> recordings, OutputKind outputs,
                        const ModelTraining& training, const FreeSizes& free, const TargetBudget& budget,
                        const std::function<void()>& on_candidate = {});

/// The number of features below `feature_count` that the search tries; 0 if there is none.
int next_smaller_features(int feature_count);

/// A table of the choice and of its neighbours.
void print_choice(std::ostream& out, const SizeChoice& choice, const TargetBudget& budget);

} // namespace dfdyn::tools
