// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidate.hpp"
#include "tools/diagnosis/signals.hpp"

namespace dfdyn::tools {

/// Friction, spring, ripple, rotor inertia and offset of every joint; none for a wrench, which does not see
/// them.
std::vector<Candidate> joint_candidates(const DiagnosisSignals& signals);

/// Payload, single links' inertia, gravity's direction.
std::vector<Candidate> body_candidates(const DiagnosisSignals& signals);

/// Encoders' errors, and what lies between encoder and link: backlash and flexibility.
std::vector<Candidate> position_candidates(const DiagnosisSignals& signals);

/// Gains, delays, biases, drifts and crosstalk of what was measured. `modelled` (T x m): what the model at
/// hand says the sensors should have shown. `delays_s` (m): delays that it has; a delay's column is what it
/// adds about there, per second. `gains_known`: whether a joint's unit can be trusted (not for currents of
/// unknown constants).
std::vector<Candidate> sensor_candidates(const DiagnosisSignals& signals, const Eigen::MatrixXd& modelled,
                                         const Eigen::VectorXd& delays_s, bool gains_known);

/// The level of a joint's friction changing with time, where `friction` (T x n) is what the model at hand
/// has; none for joints without any.
std::vector<Candidate> drift_candidates(const DiagnosisSignals& signals, const Eigen::MatrixXd& friction);

/// What has no name: dependences of each output on each joint's position or velocity, and of a joint's own
/// friction on its position. None is larger than `unexplained` (T x m), what the rigid body leaves: one that
/// is cancels a named one.
std::vector<Candidate> dependence_candidates(const DiagnosisSignals& signals,
                                             const Eigen::MatrixXd& unexplained);

/// A ripple of `joint` with these whole numbers of cycles per turn as shapes.
Candidate ripple_candidate(const DiagnosisSignals& signals, std::size_t joint,
                           const std::vector<int>& cycles);

/// A push: from start to end, rising and falling within `rise_s`.
struct ContactPulse {
    double start_s = 0, end_s = 0, rise_s = 0;
};

/// A torque or force from outside on `output`, with a pulse per shape; the first one names it.
Candidate contact_candidate(const DiagnosisSignals& signals, Eigen::Index output,
                            const std::vector<ContactPulse>& pulses);

/// The pulse over the recording, T; its height is one.
Eigen::VectorXd pulse_series(const DiagnosisSignals& signals, const ContactPulse& pulse);

} // namespace dfdyn::tools
