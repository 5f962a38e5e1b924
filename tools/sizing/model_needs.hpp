// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <cstdint>
#include <limits>
#include <string>

namespace dfdyn::tools {

/// What a model takes of a controller.
struct ModelNeeds {
    std::int64_t flash_bytes = 0;     ///< constants, where learning starts, and the code
    std::int64_t ram_bytes = 0;       ///< the estimator and the stack of a tick
    std::int64_t tick_operations = 0; ///< multiply-adds of a tick that predicts and learns its sample at once
};

/// What a model may take; nothing is limited at first.
struct TargetBudget {
    std::int64_t flash_bytes = std::numeric_limits<std::int64_t>::max();
    std::int64_t ram_bytes = std::numeric_limits<std::int64_t>::max();
    std::int64_t tick_operations = std::numeric_limits<std::int64_t>::max();
};

/// The needs of the firmware's estimator of `model`, in single precision: upper bounds, from the sizes of its
/// constants and the library's own cost(). O(size of the estimator).
ModelNeeds needs_of(const TrainedModel& model);

/// `model` with another number of features, all of them zero: for needs_of(). Model P has none.
TrainedModel with_feature_count(TrainedModel model, int feature_count);

bool fits(const ModelNeeds& needs, const TargetBudget& budget);

/// "flash 61.2 KiB, RAM 40.0 KiB, 70000 multiply-adds per tick".
std::string to_text(const ModelNeeds& needs);
std::string to_text(const TargetBudget& budget);

} // namespace dfdyn::tools
