// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/recordings/pooled_fit.hpp"
#include "tools/diagnosis/signals/signals.hpp"
#include "tools/diagnosis/verdict/arm_unknowns.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Returns the number of rows with the information of one independent row: the sum of the autocorrelation of
/// `residual` (T), both sides up to its first zero, limited to 0.1 to 1 s. Cost: O(T) per lag.
double correlated_rows(const Eigen::VectorXd& residual, const Eigen::VectorXd& weight, double rate_hz);

/// Returns the normal equations of one recording for an arm's unknowns. `measured`: T x n, joint torques.
/// `terms`: T x 5 per joint, the columns of plain least squares. The noise of each joint is its own residual,
/// with its correlation time; residuals beyond three deviations, such as those of a push, have less weight
/// (P. Huber, 1964). Cost: O((10 n)² T n).
RecordingInformation information_of(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                    const std::vector<Eigen::MatrixXd>& terms);

} // namespace dfdyn::tools
