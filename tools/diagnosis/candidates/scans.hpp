// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidates.hpp"
#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/signals/signals.hpp"

namespace dfdyn::tools {

/// Per output, the residual of a model weighed by its noise twice, in time (T x m): a column's product with
/// it is the column's share of the normal equations' right-hand side.
Eigen::MatrixXd weighed_residual(const EffectRegression& regression, const Eigen::VectorXd& coefficients);

/// The same where the residual of a joint's torque is bridged around the joint's reversals: there a friction
/// that is not quite right leaves pulses of its own.
Eigen::MatrixXd weighed_residual_away_from_reversals(const DiagnosisSignals& signals,
                                                     const EffectRegression& regression,
                                                     const Eigen::VectorXd& coefficients);

/// Of each site the stretch of time in which a push there explains most of the residual, which is best taken
/// away from reversals. `sites` must outlive the candidates.
std::vector<Candidate> scan_contacts(const DiagnosisSignals& signals, const EffectRegression& regression,
                                     const Eigen::MatrixXd& weighed, const std::vector<ContactSite>& sites);

/// A payload (`payload`: its columns) that is taken up when that explains most.
std::vector<Candidate> scan_taken_payload(const DiagnosisSignals& signals, const EffectRegression& regression,
                                          const Eigen::MatrixXd& weighed,
                                          const std::vector<EffectColumn>& payload);

/// What one that is taken up at `taken_s` has to explain, in units of the evidence: three times, as far as
/// that can be told without a fit, what it would in the fourth best of the stretches of time that are as long
/// and apart. 0 where there are not four of them: when it is there for more than about a fifth of the time.
/// Cost: T p² for p columns, and a transform per output.
double demanded_of_payload(const DiagnosisSignals& signals, const EffectRegression& regression,
                           const Eigen::MatrixXd& weighed, const std::vector<EffectColumn>& payload,
                           double taken_s);

} // namespace dfdyn::tools
