// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/recordings/pooled_fit.hpp"
#include "tools/diagnosis/signals/signals.hpp"
#include "tools/diagnosis/verdict/arm_unknowns.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Returns the number of rows that are worth one independent row: the sum of the residual's autocorrelation
/// (T, weighted) up to its first zero, from 0.1 s to 1 s. Cost: O(T) per lag.
double correlated_rows(const Eigen::VectorXd& residual, const Eigen::VectorXd& weight, double rate_hz);

/// Returns what a recording of an arm tells about the unknowns. `measured`: T x n, joint torques. `terms`: T
/// x 5 per joint, the columns of plain least squares. The noise of each joint is that of its own residual,
/// with its correlation time; residuals beyond three deviations, such as those of a push, have less weight
/// (P. Huber, 1964). Cost: O((10 n)² T n).
RecordingInformation information_of(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                    const std::vector<Eigen::MatrixXd>& terms);

} // namespace dfdyn::tools
