// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/signals/signals.hpp"

namespace dfdyn::tools {

/// Returns the residual of a model, weighted twice by the noise, as time series (T x m). The product with a
/// column is that column's entry in the right-hand side of the normal equations.
Eigen::MatrixXd weighted_residual(const EffectRegression& regression, const Eigen::VectorXd& coefficients);

/// Returns the same with the residual of each joint's torque bridged around the joint's reversals. Small
/// errors of the friction model leave pulses there.
Eigen::MatrixXd weighted_residual_away_from_reversals(const DiagnosisSignals& signals,
                                                      const EffectRegression& regression,
                                                      const Eigen::VectorXd& coefficients);

} // namespace dfdyn::tools
