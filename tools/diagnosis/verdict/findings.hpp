// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Returns the chosen effects and the contacts during standstill as findings, in descending
/// order of error reduction, with parameters, intervals, confidence and alternatives. `rest` (T x m):
/// residual after all of them.
std::vector<Finding> findings_of(const DiagnosisSignals& signals, const FittedEffects& fitted_effects,
                                 const std::vector<StationaryContact>& pushes, const Eigen::MatrixXd& rest,
                                 const std::vector<std::string>& output_names);

/// Largest confidence of a finding that other evidence contradicts.
inline constexpr double unlikely = 0.49;

/// Sorts by the ratio of the errors without and with each finding, largest first.
void sort_by_reduction(std::vector<Finding>& findings);

/// Returns the experiment that would decide whether the effect is present.
std::string confirmation(const Finding& finding);

/// Calibrated probability from the finding's margin, its effect and the recording's length.
double calibrated_confidence(const Finding& finding, double duration_s);

/// Lowers the confidence of unreliable findings below 0.5: at outputs where even the extended model errs by
/// more than the output's standard deviation, those that reduce no error by 1 % (not events, which are
/// short), and those whose size may be that without the effect.
void doubt_useless_findings(Diagnosis& diagnosis);

} // namespace dfdyn::tools
