// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/replay/replay_summary.hpp"

#include <nlohmann/json_fwd.hpp>

namespace dfdyn::tools {

/// Returns the statistics of a replay, schema `dfdyn.replay/1`; values without data are null.
nlohmann::ordered_json replay_json(const ReplaySummary& summary);

} // namespace dfdyn::tools
