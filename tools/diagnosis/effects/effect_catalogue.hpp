// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/effects/effect.hpp"

#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// To add an effect, write one file in this folder, declare it here, and add a line to the catalogue.
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
Effect link_rotational_inertia_error();
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

/// Returns all effects, in the order in which the candidates at one place are made.
const std::vector<Effect>& effect_catalogue();

/// Returns the effect with this name, or null for an unknown name. The empty name of an unnamed dependence is
/// unknown, too.
const Effect* find_effect(const std::string& name);

/// Returns the effect with this name. Throws std::logic_error for an unknown name.
const Effect& effect_named(const std::string& name);

/// Returns the trait of the effect with this name, or false for an unknown name.
bool has_trait(const std::string& effect, bool Effect::*trait);

/// Returns the candidates of `effects` that do not depend on a fitted model.
std::vector<Candidate> static_candidates(const DiagnosisSignals& signals,
                                         std::span<const Effect> effects = effect_catalogue());

/// Returns the candidates of `effects` that depend on a fitted model: gains, delays, drifts, crosstalk.
std::vector<Candidate> fitted_candidates(const DiagnosisSignals& signals, const FittedModel& model,
                                         std::span<const Effect> effects = effect_catalogue());

} // namespace dfdyn::tools
