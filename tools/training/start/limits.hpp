// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/training_data.hpp"

#include <span>

namespace dfdyn::tools {

/// What a model trained on `data` takes for possible: positions and outputs up to ten times the largest that
/// the data have (positions: at least one turn), predictions up to three times. The limits of innovations are
/// left to `calibrate_innovation_limit`.
LimitModel limits_of(const TrainingData& data);

/// Takes predicted torques back to what the joints' motors can give. `efforts`: of each output, in its unit,
/// not above 0 where unknown; one that the data exceed is not believed.
void bound_by_efforts(LimitModel& limits, std::span<const double> efforts);

} // namespace dfdyn::tools
