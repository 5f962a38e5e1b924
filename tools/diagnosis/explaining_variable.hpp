// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

#include <Eigen/Core>

#include <string>

namespace dfdyn::tools {

/// What a finding's share of an output is drawn over: velocity for friction, the angle within a turn for what
/// repeats with it, load, time, … Where an effect depends on several inputs at once, the share itself, so
/// that a right cause lies on the diagonal.
struct ExplainingVariable {
    std::string label;
    Eigen::VectorXd value;             ///< T
    Eigen::Index first = 0, count = 0; ///< the rows that are worth drawing
    bool time = false;                 ///< drawn as a line over time
};

/// `share` (T): what the finding gives on its output.
ExplainingVariable explaining_variable(const DiagnosisSignals& signals, const Finding& finding,
                                       const Eigen::VectorXd& share);

} // namespace dfdyn::tools
