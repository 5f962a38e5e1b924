// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <array>

namespace dfdyn::tools {

// Candidates whose time or shape a scan of the residual finds (implemented in the files of their effects),
// and unnamed candidates.

/// Returns the unnamed candidates: dependences of each output on each joint's position or velocity, and of a
/// joint's friction on its position. Their size is at most the size of `unexplained` (T x m), the residual of
/// the rigid body. A larger one would only cancel a named candidate.
std::vector<Candidate> dependence_candidates(const DiagnosisSignals& signals,
                                             const Eigen::MatrixXd& unexplained);

/// Returns a torque ripple of joint `number` (from 0), with one shape per number of cycles per turn.
Candidate ripple_candidate(const DiagnosisSignals& signals, std::size_t number,
                           const std::vector<int>& cycles);

/// Returns the change of the outputs per unit of a payload's mass at the tip, and of its three first moments.
/// Its moment of inertia is exact at the tip and with its centre of mass at `centre` (m, in the tip's frame).
std::vector<EffectColumn> payload_columns(const DiagnosisSignals& signals,
                                          const Eigen::Vector3d& centre = Eigen::Vector3d::Zero());

/// Returns a payload (`lasting`: its columns) that is picked up at one of these times, with two shapes for
/// each: at the tip, and with its centre of mass anywhere.
Candidate taken_payload(const DiagnosisSignals& signals, const std::vector<EffectColumn>& lasting,
                        const std::vector<double>& times_s);

/// Returns the change of the outputs (T x m) that a backlash of `gap` at a joint causes, divided by the gap.
/// A flank of the gear's teeth carries the link. When the load changes sign, the link falls freely, and the
/// other flank catches it without rebound.
Eigen::MatrixXd play_course(const DiagnosisSignals& signals, std::size_t joint, double gap);

/// Returns a backlash with one shape per gap. Each shape admits coefficients near its own gap only, because
/// the duration of the fall depends on the gap.
Candidate backlash_candidate(const DiagnosisSignals& signals, std::size_t joint,
                             const std::vector<double>& gaps);

/// A contact pulse from start to end, which rises and falls within `rise_s`.
struct ContactPulse {
    double start_s = 0, end_s = 0, rise_s = 0;
};

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

/// Returns a text that distinguishes contacts at one site: `16.20 s`.
std::string start_words(const ContactPulse& pulse);

/// Returns the catalogue's parameters, from the magnitudes of a site's components.
std::vector<EffectParameter> contact_parameters(const ContactPulse& pulse, const std::string& unit,
                                                const Eigen::VectorXd& components);

/// Returns pulses near `pulse`, which is the first: with its ends moved by `reach` (relative to its length),
/// and with steeper and flatter flanks.
std::vector<ContactPulse> pulses_about(const ContactPulse& pulse, double reach);

/// Lengths of the pulses in the search, and the share of a pulse during which it rises, and falls.
inline constexpr std::array push_lengths_s{0.5, 0.75, 1.1, 1.7, 2.5, 3.75, 5.5};
inline constexpr double push_flanks = 0.3;

/// Values of a pulse with height one, at one time and over the recording (T).
double pulse_at(const ContactPulse& pulse, double time_s);
Eigen::VectorXd pulse_series(const DiagnosisSignals& signals, const ContactPulse& pulse);

} // namespace dfdyn::tools
