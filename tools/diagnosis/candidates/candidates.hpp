// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <array>

namespace dfdyn::tools {

// Candidates whose time or shape a scan of the residual finds, by the effects' own files; and those without a
// name.

/// What has no name: dependences of each output on each joint's position or velocity, and of a joint's own
/// friction on its position. None is larger than `unexplained` (T x m), what the rigid body leaves: one that
/// is cancels a named one.
std::vector<Candidate> dependence_candidates(const DiagnosisSignals& signals,
                                             const Eigen::MatrixXd& unexplained);

/// A ripple of joint `number` (from 0) with these whole numbers of cycles per turn as shapes.
Candidate ripple_candidate(const DiagnosisSignals& signals, std::size_t number,
                           const std::vector<int>& cycles);

/// What one unit of a payload's mass at the tip adds to the outputs, then of its three first moments.
std::vector<EffectColumn> payload_columns(const DiagnosisSignals& signals);

/// A payload (`lasting`: its columns) that is taken up at one of these times, two shapes for each: at the
/// tip, and with its centre of mass anywhere.
Candidate taken_payload(const DiagnosisSignals& signals, const std::vector<EffectColumn>& lasting,
                        const std::vector<double>& times_s);

/// What play of `gap` at a joint adds to the outputs, over the gap (T x m): its link is carried on one flank
/// of the gear's teeth, falls freely where its load turns over, and is caught by the other flank without
/// springing back.
Eigen::MatrixXd play_course(const DiagnosisSignals& signals, std::size_t joint, double gap);

/// Play, with some gaps as shapes, each for coefficients near its own: the fall takes as long as the gap is
/// wide.
Candidate backlash_candidate(const DiagnosisSignals& signals, std::size_t joint,
                             const std::vector<double>& gaps);

/// A push: from start to end, rising and falling within `rise_s`.
struct ContactPulse {
    double start_s = 0, end_s = 0, rise_s = 0;
};

/// Where the surroundings can push, and what one unit of each component of a push adds to the outputs.
struct ContactSite {
    std::string where, unit;
    std::vector<EffectColumn> components;
};

/// A torque at each joint; for a wrench, a force at the tip along each of the base's axes.
std::vector<ContactSite> contact_sites(const DiagnosisSignals& signals);

/// A push at `site`, with a pulse per shape; `first` names it.
Candidate contact_candidate(const DiagnosisSignals& signals, const ContactSite& site,
                            const ContactPulse& first, const std::vector<ContactPulse>& pulses);

/// Tells pushes at one site apart: `16.20 s`.
std::string start_words(const ContactPulse& pulse);

/// The catalogue's, from how much of each of a site's components there is.
std::vector<EffectParameter> contact_parameters(const ContactPulse& pulse, const std::string& unit,
                                                const Eigen::VectorXd& components);

/// Pulses about one: its ends moved by `reach` (of its length), its flanks steeper and softer; itself first.
std::vector<ContactPulse> pulses_about(const ContactPulse& pulse, double reach);

/// Lengths of the pushes that are looked for, and the share of one in which it rises, and falls.
inline constexpr std::array push_lengths_s{0.5, 0.75, 1.1, 1.7, 2.5, 3.75, 5.5};
inline constexpr double push_flanks = 0.3;

/// Of a pulse whose height is one; and over the recording, T.
double pulse_at(const ContactPulse& pulse, double time_s);
Eigen::VectorXd pulse_series(const DiagnosisSignals& signals, const ContactPulse& pulse);

} // namespace dfdyn::tools
