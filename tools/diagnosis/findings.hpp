// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// The chosen effects of an explanation as findings, ordered by gain: parameters with intervals, confidence,
/// what else it might be and why it is not.
std::vector<Finding> findings_of(const DiagnosisSignals& signals, const Explanation& explanation,
                                 const Eigen::MatrixXd& measured,
                                 const std::vector<std::string>& output_names);

/// Half the width of a parameter's 95 % interval: its standard deviation by the regression, were the noise
/// just as weighed, and how far it is from the value that means nothing.
double reach_of_95(double deviation, double effect);

/// Calibrated probability from the finding's margin and effect, and how long the recording is.
double calibrated_confidence(const Finding& finding, double duration_s);

} // namespace dfdyn::tools
