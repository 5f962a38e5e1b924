// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/run/unit_result.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// ε of one case against time since the subset's start. NaN where there is none, infinite where a draw lost
/// the tick.
struct ErrorCurve {
    std::vector<double> time_s;
    std::vector<double> mean;      ///< over subsets and draws
    std::vector<double> low, high; ///< quartiles of the draws, each averaged over its subsets
};

/// The paper's curve, tick by tick: the mean over the subsets that have a value there, then over draws.
ErrorCurve error_curve(std::span<const UnitResult* const> draws, std::size_t group);

/// The curve with at most `per_decade` points in a decade of time, each the mean over its stretch of times,
/// for a logarithmic axis. Points at time 0 and stretches without values are left out.
ErrorCurve thinned(const ErrorCurve& curve, int per_decade);

} // namespace dfdyn::tools
