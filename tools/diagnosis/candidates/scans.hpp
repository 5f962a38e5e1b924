// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidates.hpp"
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

/// Returns, for each site, the time windows in which a contact explains most of the residual. The residual
/// should be bridged around reversals. `sites` must outlive the candidates.
std::vector<Candidate> scan_contacts(const DiagnosisSignals& signals, const EffectRegression& regression,
                                     const Eigen::MatrixXd& weighted, const std::vector<ContactSite>& sites);

/// Returns a payload (`payload`: its columns) that is picked up at the time that explains most.
std::vector<Candidate> scan_taken_payload(const DiagnosisSignals& signals, const EffectRegression& regression,
                                          const Eigen::MatrixXd& weighted,
                                          const std::vector<EffectColumn>& payload);

/// Minimum log-evidence required of a payload picked up at `taken_s`: three times the approximate
/// log-evidence of the fourth-best non-overlapping window of the same length. Returns 0 if fewer than four
/// windows fit, that is, if the payload is present for more than about a fifth of the time. Cost: T p² for p
/// columns, and one transform per output.
double payload_evidence_threshold(const DiagnosisSignals& signals, const EffectRegression& regression,
                                  const Eigen::MatrixXd& weighted, const std::vector<EffectColumn>& payload,
                                  double taken_s);

} // namespace dfdyn::tools
