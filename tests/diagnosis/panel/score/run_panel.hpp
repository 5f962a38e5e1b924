// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel/score/panel_score.hpp"

#include <functional>
#include <vector>

namespace dfdyn::tests {

/// Makes, diagnoses and scores the cases of seeds `seed` to `seed` + `cases` - 1 with `threads` threads.
/// Calls `done` for each completed case, one at a time. The scores are in the order of the seeds, without
/// those whose arm and motion cannot have the requested effect.
std::vector<CaseScore> run_panel(std::uint64_t seed, int cases, const PanelMix& mix, int threads,
                                 const std::function<void(const CaseScore&)>& done);

} // namespace dfdyn::tests
