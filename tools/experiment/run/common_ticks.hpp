// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/experiment/run/unit_result.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// The largest window of any case of the plan, in rows before a tick.
std::size_t largest_window(const Plan& plan);

/// Ticks of a subset that a group of outputs is scored at: those that every case of the plan can have. Since
/// the subset's start, and since the last gap in it, there are the rows of the largest window of any case;
/// the `horizon` samples that follow are there without a gap; and, where they are the scale of ε, no output
/// of the group is 0 in all of them. Cost O(rows horizon outputs).
std::vector<bool> common_ticks(const Plan& plan, const PlanData& data, std::size_t group, std::size_t subset);

/// Makes the units' errors comparable: NaN at all other ticks, infinite at common ticks where a unit has no
/// finite error, since it diverged or its estimator refused a sample.
void keep_common_ticks(const Plan& plan, const PlanData& data, std::span<UnitResult> units);

} // namespace dfdyn::tools
