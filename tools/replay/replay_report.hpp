// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/replay/replay_summary.hpp"
#include "tools/report/report.hpp"

#include <span>

namespace dfdyn::tools {

/// Returns the report of a replay: tables, then curves of every output over all recordings.
Report make_replay_report(const TrainedModel& model, std::span<const ReplayedRecording> replayed,
                          const ReplaySummary& summary);

} // namespace dfdyn::tools
