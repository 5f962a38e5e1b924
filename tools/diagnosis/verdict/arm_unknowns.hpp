// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/signals.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Terms of plain least squares per joint (`TextbookTerm`).
inline constexpr Eigen::Index terms_of_joint = 5;

/// Standard deviation (SI units) of a term without a prior.
inline constexpr double unknown_deviation = 1e3;

/// Returns the index of the first term of a joint among the unknowns of an arm: the links' parameters (10 per
/// body), then the terms of each joint, all as differences from the robot's file.
inline Eigen::Index first_term(const DiagnosisSignals& signals, Eigen::Index joint) {
    return signals.regressor.cols() + terms_of_joint * joint;
}

/// Returns the prior standard deviations (10 per body) of the errors of the links' parameters in the file.
Eigen::VectorXd link_deviations(const DiagnosisSignals& signals);

/// Returns the indices of the unknowns on which a joint's torque depends: all links' parameters, then its own
/// terms.
std::vector<Eigen::Index> unknowns_of(const DiagnosisSignals& signals, Eigen::Index joint);

/// Returns the columns (T x unknowns) of `unknowns_of`. `terms`: T x 5, columns of plain least squares.
Eigen::MatrixXd arm_columns(const DiagnosisSignals& signals, Eigen::Index joint,
                            const Eigen::MatrixXd& terms);

/// Returns the weights (T) of a joint's rows; all are 0 for a joint that hardly moves.
Eigen::VectorXd moving_weight(const DiagnosisSignals& signals, Eigen::Index joint);

} // namespace dfdyn::tools
