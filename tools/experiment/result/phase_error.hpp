// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan.hpp"
#include "tools/experiment/result/box.hpp"
#include "tools/experiment/run/job_result.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// Returns the errors of one group in one subset within a phase: before or after `steady_after_s` since the
/// subset's start. Without NaN; infinite errors, of lost ticks, are included.
std::vector<double> errors_of_phase(const JobResult& job, std::size_t group, std::size_t subset, Phase phase,
                                    double steady_after_s);

/// Returns one number for a phase: the mean of the transient, in which large initial errors count fully, or
/// the median of the steady state, the line in the paper's box plots. Infinite if lost ticks dominate; NaN
/// without errors.
double phase_error(const JobResult& job, std::size_t group, std::size_t subset, Phase phase,
                   double steady_after_s);

/// Returns the share of lost ticks (with infinite error) among the scored ticks of both phases, all subsets
/// and draws; 0 without ticks.
double lost_share(std::span<const JobResult* const> draws, std::size_t group);

/// Returns the distribution over all times of the phase, subsets and draws.
Box phase_box(std::span<const JobResult* const> draws, std::size_t group, Phase phase, double steady_after_s);

} // namespace dfdyn::tools
