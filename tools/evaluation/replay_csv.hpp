// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/evaluation/replay.hpp"

#include <ostream>
#include <span>

namespace dfdyn::tools {

/// Writes one row per tick: `t`, then for each output its measured value, prediction and standard deviation
/// (`tau1`, `tau1_pred`, `tau1_std`), `nis`, `learned` (0 or 1), `status`. nan where nothing was predicted.
/// Recordings follow one another; where one begins, t starts again.
void write_replay_csv(std::ostream& out, const TrainedModel& model,
                      std::span<const ReplayedRecording> recordings);

} // namespace dfdyn::tools
