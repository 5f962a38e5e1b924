// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// The chosen effects of an explanation as findings, ordered by gain: parameters with intervals, confidence,
/// what else it might be and why it is not.
std::vector<Finding> findings_of(const DiagnosisSignals& signals, const Explanation& explanation,
                                 const Eigen::MatrixXd& measured,
                                 const std::vector<std::string>& output_names);

/// Calibrated probability from the logarithms of the odds against there being nothing, and against the best
/// other cause.
double calibrated_confidence(double margin_to_nothing, double margin_to_others);

} // namespace dfdyn::tools
