// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/run/job_result.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// ε of one case over the time since the subset's start. NaN without a value, infinite if a draw lost the
/// tick.
struct ErrorCurve {
    std::vector<double> time_s;
    std::vector<double> mean;      ///< over subsets and draws
    std::vector<double> low, high; ///< quartiles of the draws, each averaged over its subsets
};

/// Returns the paper's curve, tick by tick: the mean over the subsets with a value, then over the draws.
ErrorCurve error_curve(std::span<const JobResult* const> draws, std::size_t group);

/// Returns the curve with at most `per_decade` points per decade of time, each the mean over its time
/// interval, for a logarithmic axis. Points at time 0 and intervals without values are left out.
ErrorCurve thinned(const ErrorCurve& curve, int per_decade);

} // namespace dfdyn::tools
