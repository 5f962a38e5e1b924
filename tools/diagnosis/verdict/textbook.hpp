// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/signals.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// Plain least squares of each output by itself, as in textbooks on identification: gain · rigid body +
/// inertia · acceleration + viscous · velocity + dry · direction + offset, of the output's joint; for a
/// wrench gain · rigid body + offset.
struct TextbookFit {
    /// 5 x m: gain (1), inertia (kg·m²), viscous friction (N·m·s/rad), dry friction (N·m), offset (N·m)
    Eigen::MatrixXd coefficients;
    Eigen::MatrixXd prediction; ///< T x m, N·m (N)
};

/// Returns the columns (T x 5) of an output, in the order of `TextbookTerm`. `rigid` (T): the rigid body's.
Eigen::MatrixXd textbook_columns(const DiagnosisSignals& signals, const Eigen::VectorXd& rigid,
                                 Eigen::Index output);

/// Fits the first `rows` rows of `measured`, T x m, with the rigid body's outputs `rigid`, T x m. All rows
/// have the same weight. Cost: O(25 T m).
TextbookFit textbook_fit(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                         const Eigen::MatrixXd& rigid, Eigen::Index rows);

} // namespace dfdyn::tools
