// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Returns the chosen effects of an explanation and the contacts during standstill as findings, in descending
/// order of gain, with parameters, intervals, confidence and alternatives. `rest` (T x m): residual after all
/// of them.
std::vector<Finding> findings_of(const DiagnosisSignals& signals, const Explanation& explanation,
                                 const std::vector<StandingContact>& pushes, const Eigen::MatrixXd& rest,
                                 const std::vector<std::string>& output_names);

/// Calibrated probability from the finding's margin, its effect and the recording's length.
double calibrated_confidence(const Finding& finding, double duration_s);

} // namespace dfdyn::tools
