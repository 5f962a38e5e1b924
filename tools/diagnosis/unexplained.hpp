// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// What is still predictable of the outputs once all findings are taken off, and from which inputs: smooth
/// functions of each joint's position, velocity and acceleration, added one at a time while they lower the
/// error of blocks of time that fitted nothing. Empty when what is left is noise.
std::vector<Unexplained> unexplained_rest(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                          const Eigen::MatrixXd& rest, const Eigen::MatrixXd& noise);

} // namespace dfdyn::tools
