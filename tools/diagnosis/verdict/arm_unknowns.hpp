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

/// Returns the number of the first term of a joint among the unknowns of an arm: the links' parameters (10
/// per body), then the terms of each joint, all as differences from the robot's file.
inline Eigen::Index first_term(const DiagnosisSignals& signals, Eigen::Index joint) {
    return signals.regressor.cols() + terms_of_joint * joint;
}

/// Returns the standard deviations (10 per body) of the links' parameters: what a robot's file may be wrong
/// by.
Eigen::VectorXd link_deviations(const DiagnosisSignals& signals);

/// Returns the numbers of the unknowns on which a joint's torque depends: all links' parameters, then its own
/// terms.
std::vector<Eigen::Index> unknowns_of(const DiagnosisSignals& signals, Eigen::Index joint);

/// Returns the columns (T x) of those unknowns. `terms`: T x 5, those of plain least squares.
Eigen::MatrixXd arm_columns(const DiagnosisSignals& signals, Eigen::Index joint,
                            const Eigen::MatrixXd& terms);

/// Returns the weights (T) of a joint's rows; a joint that hardly moves has none.
Eigen::VectorXd moving_weight(const DiagnosisSignals& signals, Eigen::Index joint);

} // namespace dfdyn::tools
