// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// The chosen effects of an explanation as findings, ordered by gain: parameters with intervals, confidence,
/// what else it might be and why it is not.
std::vector<Finding> findings_of(const DiagnosisSignals& signals, const Explanation& explanation,
                                 const Eigen::MatrixXd& measured,
                                 const std::vector<std::string>& output_names);

/// Calibrated probability from the finding's margins, ties and effect.
double calibrated_confidence(const Finding& finding);

} // namespace dfdyn::tools
