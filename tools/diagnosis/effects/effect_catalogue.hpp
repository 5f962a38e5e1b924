// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/effects/effect.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// A new effect is one file in this folder, with one line here and one in the catalogue.
namespace effects {

Effect viscous_friction();
Effect coulomb_friction();
Effect stribeck_friction();
Effect presliding_hysteresis();
Effect joint_spring();
Effect load_dependent_friction();
Effect torque_offset();
Effect rotor_inertia();
Effect torque_ripple();
Effect friction_drift();
Effect external_contact();
Effect payload();
Effect gravity_tilt();
Effect link_inertia_error();
Effect encoder_offset();
Effect encoder_eccentricity();
Effect joint_flexibility();
Effect backlash();
Effect delay();
Effect actuator_gain();
Effect ft_bias();
Effect ft_drift();
Effect ft_rotation();
Effect ft_gain();
Effect ft_crosstalk();

} // namespace effects

/// All of them, in the order in which candidates at one place are made.
const std::vector<Effect>& effect_catalogue();

/// Null for a name that is none of them, as the empty one of an unnamed dependence.
const Effect* find_effect(const std::string& name);

/// Throws std::logic_error for a name that is none of them.
const Effect& effect_named(const std::string& name);

/// False for a name that is none of them.
bool has_trait(const std::string& effect, bool Effect::*trait);

/// Candidates that do not depend on a fitted model.
std::vector<Candidate> lasting_candidates(const DiagnosisSignals& signals);

/// Candidates that do: gains, delays, drifts, crosstalk.
std::vector<Candidate> fitted_candidates(const DiagnosisSignals& signals, const FittedModel& model);

} // namespace dfdyn::tools
