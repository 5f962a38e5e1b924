// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/recording/recording.hpp"

#include <functional>
#include <span>

namespace dfdyn::tools {

/// The one of `candidates` (not empty) with which `model`, learning from its start on over `recording`, errs
/// least one step ahead: the mean over the outputs of rms(measured − predicted) / std(measured). A candidate
/// that diverges counts as infinitely bad; of equals the first. `progress`: told the share that is done,
/// 0 … 1. A single candidate costs nothing.
double choose_forgetting(const TrainedModel& model, std::span<const double> candidates,
                         const Recording& recording, const std::function<void(double)>& progress);

} // namespace dfdyn::tools
