// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan.hpp"
#include "tools/experiment/result/box.hpp"
#include "tools/experiment/run/unit_result.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// The errors of one group in one subset that belong to a phase: before, or from, `steady_after_s` since the
/// subset's start. Without the NaN; infinite ones, of lost ticks, included.
std::vector<double> errors_of_phase(const UnitResult& unit, std::size_t group, std::size_t subset,
                                    Phase phase, double steady_after_s);

/// One number for them: the mean of the transient, in which the first seconds weigh as they err; the median
/// of the steady state, the line in the paper's box plots. Infinite where lost ticks make it so; NaN without
/// any errors.
double phase_error(const UnitResult& unit, std::size_t group, std::size_t subset, Phase phase,
                   double steady_after_s);

/// Share of the scored ticks, over both phases, subsets and draws, that were lost: at which the error is
/// infinite. 0 without any.
double lost_share(std::span<const UnitResult* const> draws, std::size_t group);

/// The distribution over all times of the phase, subsets and draws.
Box phase_box(std::span<const UnitResult* const> draws, std::size_t group, Phase phase,
              double steady_after_s);

} // namespace dfdyn::tools
