// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidate.hpp"
#include "tools/diagnosis/effect_regression.hpp"
#include "tools/diagnosis/signals.hpp"

namespace dfdyn::tools {

/// Per output, the residual of a model weighed by its noise twice, in time (T x m): a column's product with
/// it is the column's share of the normal equations' right-hand side.
Eigen::MatrixXd weighed_residual(const EffectRegression& regression, const Eigen::VectorXd& coefficients);

/// Of each joint the numbers of cycles per turn that go best with the residual; candidates have these and
/// their neighbours as shapes. Whole numbers from 2 to 200 whose frequency stays within the analysed band.
std::vector<Candidate> scan_ripples(const DiagnosisSignals& signals, const EffectRegression& regression,
                                    const Eigen::MatrixXd& weighed);

/// The stretches of time in which a push from outside explains most of the residual, over all outputs; a few,
/// the best first.
std::vector<Candidate> scan_contacts(const DiagnosisSignals& signals, const EffectRegression& regression,
                                     const Eigen::MatrixXd& weighed);

} // namespace dfdyn::tools
