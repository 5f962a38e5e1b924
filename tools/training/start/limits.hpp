// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/training_data.hpp"

#include <span>

namespace dfdyn::tools {

/// Returns the plausible range for a model trained on `data`: positions and outputs up to ten times their
/// largest magnitudes in the data (positions: at least one turn), predictions up to three times. The limits
/// of innovations are set by `calibrate_innovation_limit`.
LimitModel limits_of(const TrainingData& data);

/// Limits predicted torques to the motors' capability. `efforts`: one per output, in its unit; not positive
/// if unknown. An effort that the data exceed is ignored.
void bound_by_efforts(LimitModel& limits, std::span<const double> efforts);

} // namespace dfdyn::tools
