// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// The chosen effects of an explanation and the pushes at joints that stood as findings, ordered by gain:
/// parameters with intervals, confidence, what else it might be and why it is not. `rest` (T x m): what none
/// of them explains.
std::vector<Finding> findings_of(const DiagnosisSignals& signals, const Explanation& explanation,
                                 const std::vector<StandingContact>& pushes, const Eigen::MatrixXd& rest,
                                 const std::vector<std::string>& output_names);

/// Calibrated probability from the finding's margin and effect, and how long the recording is.
double calibrated_confidence(const Finding& finding, double duration_s);

} // namespace dfdyn::tools
