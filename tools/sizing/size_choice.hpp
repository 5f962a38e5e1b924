// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sizing/model_needs.hpp"
#include "tools/training/model_training.hpp"

#include <functional>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Smallest number of features that the choice considers.
inline constexpr int least_feature_count = 10;

/// Settings that the choice may change; the caller determines the others.
struct FreeSizes {
    bool window = true;   ///< M and the spacing of lags
    bool rows = true;     ///< k of input DFR
    bool features = true; ///< d
    bool memory = true;   ///< the forgetting factor
};

/// One evaluated set of sizes.
struct SizeCandidate {
    TrainingOptions options;
    double window_s = 0;
    double memory_s = 0; ///< 0: unlimited
    ModelNeeds needs;
    double error = 0; ///< `held_out_error`
};

struct SizeChoice {
    SizeCandidate chosen;
    std::optional<SizeCandidate> smaller,
        larger; ///< the neighbouring numbers of features; the larger one may exceed the budget
    std::vector<SizeRecord> sizes; ///< of all numbers of features that were compared, for the model's record
    int tried = 0;                 ///< number of trained models
};

/// Chooses sizes within `budget` by a coordinate search: window, rows per joint, memory, features. Each
/// candidate is trained on the first 70 % of the rows, with few starts and likelihood rows. It is evaluated
/// one step ahead on the rest, with learning. Of candidates with errors within 1 %, the one with fewer
/// operations is chosen. Numbers of features for which the forgetting factor is too small are left out (see
/// least_forgetting_factor()). Equal data give equal choices. `on_candidate` is called before each training.
/// Throws InputError if nothing fits the budget, if no output changes in the last 30 % although a size is
/// free, and as train_model() does. Cost: about ten trainings.
SizeChoice choose_sizes(std::span<const Recording> recordings, OutputKind outputs,
                        const ModelTraining& training, const FreeSizes& free, const TargetBudget& budget,
                        const std::function<void()>& on_candidate = {});

/// Returns the error of `model`, which starts as trained and learns, over recordings: nRMSE of the one-step
/// predictions over the ticks of all recordings together, mean over the outputs. An output without any
/// prediction counts 1, as good as a constant; one that never changes is left out. Infinite if none changes.
double held_out_error(const TrainedModel& model, std::span<const Recording> recordings);

/// Throws InputError unless an output changes over the rows of `judging` (at least one recording): otherwise
/// held_out_error() is infinite for every model. `rows` names these rows for the message.
void require_varying_outputs(std::span<const Recording> judging, const std::string& rows);

/// Returns the next smaller number of features of the search; 0 if there is none.
int next_smaller_features(int feature_count);

/// Prints a table of the choice and its neighbours.
void print_choice(std::ostream& out, const SizeChoice& choice, const TargetBudget& budget);

} // namespace dfdyn::tools
