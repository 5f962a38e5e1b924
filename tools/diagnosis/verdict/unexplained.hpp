// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// What an explanation has no name for, though it is there.
std::vector<Unexplained> unnamed_dependences(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                             const Explanation& explanation);

/// Joins what is told of the same output.
void add_rest(std::vector<Unexplained>& unexplained, const std::vector<Unexplained>& rest);

/// What is still predictable of the outputs once all findings are taken off, and from which inputs: smooth
/// functions of each joint's position, velocity and acceleration, added one at a time while they lower the
/// error of blocks of time that fitted nothing. Empty when what is left is noise.
std::vector<Unexplained> unexplained_rest(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                          const Eigen::MatrixXd& rest, const Eigen::MatrixXd& noise);

} // namespace dfdyn::tools
