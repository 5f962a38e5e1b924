// SPDX-License-Identifier: Apache-2.0
// Parts of effects that tests use on their own. Each is implemented in the file of its effect.
#pragma once

#include "tools/diagnosis/candidates/contact_pulse.hpp"
#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Returns a torque ripple of joint `number` (from 0), with one shape per number of cycles per turn.
Candidate ripple_candidate(const DiagnosisSignals& signals, std::size_t number,
                           const std::vector<int>& cycles);

/// Returns the change of the outputs per unit of a payload's mass at the tip, and of its three first moments.
/// Its moment of inertia is exact at the tip and with its centre of mass at `centre` (m, in the tip's frame).
std::vector<EffectColumn> payload_columns(const DiagnosisSignals& signals,
                                          const Eigen::Vector3d& centre = Eigen::Vector3d::Zero());

/// Returns a payload (`permanent`: its columns) that is picked up at one of these times, with two shapes for
/// each: at the tip, and with its centre of mass anywhere, as far as the motion determines it.
Candidate taken_payload(const DiagnosisSignals& signals, const std::vector<EffectColumn>& permanent,
                        const std::vector<double>& times_s);

/// Minimum log-evidence required of a payload picked up at `taken_s`: three times the approximate
/// log-evidence of the fourth-best non-overlapping window of the same length. Returns 0 if fewer than four
/// windows fit, that is, if the payload is present for more than about a fifth of the time. Cost: T p² for p
/// columns, and one transform per output.
double payload_evidence_threshold(const DiagnosisSignals& signals, const EffectRegression& regression,
                                  const Eigen::MatrixXd& weighted, const std::vector<EffectColumn>& payload,
                                  double taken_s);

/// Returns a backlash with one shape per gap. Each shape admits coefficients near its own gap only, because
/// the duration of the fall depends on the gap.
Candidate backlash_candidate(const DiagnosisSignals& signals, std::size_t joint,
                             const std::vector<double>& gaps);

/// A place where a contact can act, and the change of the outputs per unit of each component of the contact.
struct ContactSite {
    std::string where, unit;
    std::vector<EffectColumn> components;
};

/// Returns the contact sites: a torque at each joint; for a wrench, a force at the tip along each axis of the
/// base.
std::vector<ContactSite> contact_sites(const DiagnosisSignals& signals);

/// Returns a contact at `site`, with one shape per pulse; `first` determines its name.
Candidate contact_candidate(const DiagnosisSignals& signals, const ContactSite& site,
                            const ContactPulse& first, const std::vector<ContactPulse>& pulses);

/// Returns pulses near `pulse`, which is the first: with its ends moved by `reach` (relative to its length),
/// and with steeper and flatter flanks.
std::vector<ContactPulse> pulses_about(const ContactPulse& pulse, double reach);

/// Returns, for each site, the time windows in which a contact explains most of the residual. The residual
/// should be bridged around reversals. `sites` must outlive the candidates.
std::vector<Candidate> scan_contacts(const DiagnosisSignals& signals, const EffectRegression& regression,
                                     const Eigen::MatrixXd& weighted, const std::vector<ContactSite>& sites);

} // namespace dfdyn::tools
