// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan_data.hpp"
#include "tools/experiment/run/job_result.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Returns the largest window of any case of the plan, in rows before a tick.
std::size_t largest_window(const Plan& plan);

/// Returns the ticks of a subset at which a group of outputs is scored: those that are available for every
/// case of the plan. At such a tick, the largest window of any case lies within the subset without a gap, and
/// so do the following `horizon` samples. If the outputs are the scale of ε, each output of the group is
/// nonzero in at least one of these samples. Cost O(rows horizon outputs).
std::vector<bool> common_ticks(const Plan& plan, const PlanData& data, std::size_t group, std::size_t subset);

/// Makes the jobs' errors comparable: NaN at all other ticks, and infinite at common ticks without a finite
/// error, where a job diverged or its estimator rejected a sample.
void keep_common_ticks(const Plan& plan, const PlanData& data, std::span<JobResult> jobs);

} // namespace dfdyn::tools
