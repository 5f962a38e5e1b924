// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Returns the unnamed dependences that the fit contains.
std::vector<Unexplained> unnamed_dependences(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                             const FittedEffects& fitted_effects);

/// Merges the entries of the same output.
void add_rest(std::vector<Unexplained>& unexplained, const std::vector<Unexplained>& rest);

/// Returns the predictable part of the residual after all findings, and its inputs: smooth functions of each
/// joint's position, velocity and acceleration. Functions are added one at a time while they reduce the error
/// of held-out blocks of time. Empty if the residual is noise.
std::vector<Unexplained> unexplained_rest(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                          const Eigen::MatrixXd& rest, const Eigen::MatrixXd& noise);

/// Sets `unexplained` of the diagnosis: per output, the predictable residual that matches no cause of the
/// catalogue. Where plain least squares is the extended model, it is the residual of plain least squares.
void set_unexplained(DiagnosisWork& work);

} // namespace dfdyn::tools
