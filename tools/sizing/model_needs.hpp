// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <cstdint>
#include <limits>
#include <string>

namespace dfdyn::tools {

/// Resources that a model needs on a controller.
struct ModelNeeds {
    std::int64_t flash_bytes = 0; ///< constants, initial state, and code
    std::int64_t ram_bytes = 0;   ///< the estimator, and the stack of a tick
    /// multiply-adds of a tick that predicts and learns its sample completely
    std::int64_t tick_operations = 0;

    std::int64_t stack_bytes = 0;        ///< of ram_bytes: the stack of a tick
    std::int64_t predict_operations = 0; ///< of tick_operations: the prediction
    std::int64_t learn_operations = 0;   ///< of tick_operations: learning
    std::int64_t learned_columns = 0;    ///< of the regressions that a sample updates
    std::int64_t forget_operations = 0;  ///< of tick_operations: forgetting, at most
    /// of the standard deviation, in addition in a tick that does not learn or that contradicts the model
    std::int64_t variance_operations = 0;
};

/// Limits of a model's resources; unlimited by default.
struct TargetBudget {
    std::int64_t flash_bytes = std::numeric_limits<std::int64_t>::max();
    std::int64_t ram_bytes = std::numeric_limits<std::int64_t>::max();
    std::int64_t tick_operations = std::numeric_limits<std::int64_t>::max();
};

/// Returns upper bounds of the needs of the firmware's estimator of `model` in single precision, from the
/// sizes of its constants and the library's cost(). O(size of the estimator).
ModelNeeds needs_of(const TrainedModel& model);

/// Returns `model` with another number of features, all zero, for needs_of(). Model P has none.
TrainedModel with_feature_count(TrainedModel model, int feature_count);

bool fits(const ModelNeeds& needs, const TargetBudget& budget);

/// Returns what exceeds the budget, like "flash: expected at most 2 KiB, found 24.1 KiB"; empty: nothing.
std::string excess_text(const ModelNeeds& needs, const TargetBudget& budget);

/// Returns a size in KiB, rounded up to tenths: a bound remains one, and a size beyond a budget exceeds it as
/// text, too.
double kib_rounded_up(std::int64_t bytes);

/// Returns text like "flash 61.2 KiB, RAM 40.0 KiB, 70000 multiply-adds per tick", with sizes rounded up.
std::string to_text(const ModelNeeds& needs);
/// Returns text like "flash 64 KiB, RAM unlimited, unlimited multiply-adds per tick", with exact sizes.
std::string to_text(const TargetBudget& budget);

} // namespace dfdyn::tools
