// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/effects/panel_effect.hpp"

#include "tools/base/text/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

/// Generators of the catalogue's effects for setups whose outputs show them. Defined in panel_*_effects.cpp.
namespace hidden_effects {

DrawnEffect viscous_friction(const EffectDraw& of);
DrawnEffect coulomb_friction(const EffectDraw& of);
DrawnEffect stribeck_friction(const EffectDraw& of);
DrawnEffect load_dependent_friction(const EffectDraw& of);
DrawnEffect presliding_hysteresis(const EffectDraw& of);
DrawnEffect torque_offset(const EffectDraw& of);
DrawnEffect rotor_inertia(const EffectDraw& of);
DrawnEffect joint_spring(const EffectDraw& of);
DrawnEffect torque_ripple(const EffectDraw& of);
DrawnEffect backlash(const EffectDraw& of);
DrawnEffect greased_backlash(const EffectDraw& of);
DrawnEffect joint_flexibility(const EffectDraw& of);
DrawnEffect actuator_gain(const EffectDraw& of);
DrawnEffect payload(const EffectDraw& of);
DrawnEffect link_inertia_error(const EffectDraw& of);
DrawnEffect link_rotational_inertia_error(const EffectDraw& of);
DrawnEffect gravity_tilt(const EffectDraw& of);
DrawnEffect ft_bias(const EffectDraw& of);
DrawnEffect ft_drift(const EffectDraw& of);
DrawnEffect ft_gain(const EffectDraw& of);
DrawnEffect ft_crosstalk(const EffectDraw& of);
DrawnEffect ft_rotation(const EffectDraw& of);
DrawnEffect encoder_offset(const EffectDraw& of);
DrawnEffect encoder_eccentricity(const EffectDraw& of);
DrawnEffect delay(const EffectDraw& of);
DrawnEffect friction_drift(const EffectDraw& of);
DrawnEffect external_contact(const EffectDraw& of);

} // namespace hidden_effects

namespace {

enum class Shows { torque, wrench, both };

struct Traits {
    bool of_gear = false; ///< cannot be hidden in a gear that has friction and a rotor anyway
    /// Left out of random cases, so that the case of a seed is the same as before this effect was added.
    bool on_request = false;
};

struct CatalogueEntry {
    const char* name;
    Shows shows;
    DrawnEffect (*draw)(const EffectDraw& of);
    Traits traits = {};
};

constexpr auto catalogue = std::to_array<CatalogueEntry>({
    {"viscous_friction", Shows::torque, hidden_effects::viscous_friction, {.of_gear = true}},
    {"coulomb_friction", Shows::torque, hidden_effects::coulomb_friction, {.of_gear = true}},
    {"stribeck_friction", Shows::torque, hidden_effects::stribeck_friction, {.of_gear = true}},
    {"load_dependent_friction", Shows::torque, hidden_effects::load_dependent_friction, {.of_gear = true}},
    {"presliding_hysteresis", Shows::torque, hidden_effects::presliding_hysteresis, {.of_gear = true}},
    {"torque_offset", Shows::torque, hidden_effects::torque_offset},
    {"rotor_inertia", Shows::torque, hidden_effects::rotor_inertia, {.of_gear = true}},
    {"joint_spring", Shows::torque, hidden_effects::joint_spring},
    {"torque_ripple", Shows::torque, hidden_effects::torque_ripple},
    {"backlash", Shows::both, hidden_effects::backlash, {.of_gear = true}},
    {"joint_flexibility", Shows::both, hidden_effects::joint_flexibility, {.of_gear = true}},
    {"actuator_gain", Shows::torque, hidden_effects::actuator_gain},
    {"payload", Shows::both, hidden_effects::payload},
    {"link_inertia_error", Shows::both, hidden_effects::link_inertia_error},
    {"gravity_tilt", Shows::both, hidden_effects::gravity_tilt},
    {"ft_bias", Shows::wrench, hidden_effects::ft_bias},
    {"ft_drift", Shows::wrench, hidden_effects::ft_drift},
    {"ft_gain", Shows::wrench, hidden_effects::ft_gain},
    {"ft_crosstalk", Shows::wrench, hidden_effects::ft_crosstalk},
    {"ft_rotation", Shows::wrench, hidden_effects::ft_rotation},
    {"encoder_offset", Shows::both, hidden_effects::encoder_offset},
    {"encoder_eccentricity", Shows::both, hidden_effects::encoder_eccentricity},
    {"delay", Shows::both, hidden_effects::delay},
    {"friction_drift", Shows::torque, hidden_effects::friction_drift, {.of_gear = true}},
    {"external_contact", Shows::both, hidden_effects::external_contact},
    {"link_rotational_inertia_error",
     Shows::both,
     hidden_effects::link_rotational_inertia_error,
     {.on_request = true}},
    {"greased_backlash",
     Shows::both,
     hidden_effects::greased_backlash,
     {.of_gear = true, .on_request = true}},
});

/// The robot with the bodies of all payloads, including those that are attached later.
Robot with_payloads(Robot robot, const Scenario& scenario) {
    for (const Payload& payload : scenario.payloads) {
        const InertialParameters body =
            body_parameters(payload.mass, robot.tip_placement * payload.centre, Eigen::Matrix3d::Zero());
        robot.joints.back().inertia += body;
        if (robot.sensor && robot.sensor->link == robot.joints.size()) {
            robot.sensor->inertia_beyond += body;
        }
    }
    return robot;
}

/// The motion as the encoders measure it.
MotionRows shown(const MotionRows& motion, const EncoderModel& encoders) {
    MotionRows result = motion;
    for (Eigen::Index joint = 0; joint < motion.position.cols(); ++joint) {
        const Eigen::ArrayXd angle = motion.position.col(joint).array() + encoders.eccentricity_phase[joint];
        result.position.col(joint).array() +=
            encoders.eccentricity[joint] * angle.sin() + (encoders.offset ? (*encoders.offset)[joint] : 0);
    }
    return result;
}

} // namespace

std::vector<std::string> panel_effect_names(bool all) {
    std::vector<std::string> names;
    for (const CatalogueEntry& entry : catalogue) {
        if (all || !entry.traits.on_request) {
            names.emplace_back(entry.name);
        }
    }
    return names;
}

bool shows(const std::string& effect, OutputKind outputs, bool constants_known) {
    const auto* const entry = std::ranges::find(catalogue, effect, &CatalogueEntry::name);
    if (entry == catalogue.end()) {
        return outputs != OutputKind::wrench; // outside the catalogue: all act on the joints
    }
    if (effect == "actuator_gain" && !constants_known) {
        return false;
    }
    return entry->shows == Shows::both || (entry->shows == Shows::wrench) == (outputs == OutputKind::wrench);
}

bool fits_ordinary_gears(const std::string& effect) {
    const auto* const entry = std::ranges::find(catalogue, effect, &CatalogueEntry::name);
    return entry != catalogue.end() && !entry->traits.of_gear; // those outside are friction or a coupling
}

std::optional<DrawnEffect> draw_effect(const std::string& name, const EffectDraw& of) {
    if (!shows(name, of.setup.kind.outputs, of.setup.constants_known)) {
        return std::nullopt;
    }
    const auto* const entry = std::ranges::find(catalogue, name, &CatalogueEntry::name);
    std::optional<DrawnEffect> drawn =
        entry == catalogue.end() ? draw_outside_effect(name, of) : entry->draw(of);
    if (!drawn) {
        throw InputError("effect: expected one of the catalogue or outside of it, found " + name);
    }
    if (drawn->effect.empty()) {
        drawn->effect = name;
    }
    return drawn;
}

double rms(const Eigen::VectorXd& column) {
    return std::sqrt(column.squaredNorm() / static_cast<double>(column.size()));
}

namespace {

double strongest(const PanelSetup& setup, const Eigen::MatrixXd& difference) {
    double result = 0;
    for (Eigen::Index output = 0; output < setup.outputs(); ++output) {
        result = std::max(result, rms(difference.col(output)) / setup.noise_in_band[output]);
    }
    return result;
}

} // namespace

Eigen::VectorXd joint_torque(const PanelSetup& setup, Eigen::Index joint) {
    PanelSetup torques = setup;
    torques.kind.outputs = OutputKind::joint_torque;
    torques.torque_constants.setOnes();
    return rigid_outputs(torques, setup.robot, setup.reference).col(joint);
}

double strength_along_reference(const PanelSetup& setup, const MotionRows& real) {
    return strongest(setup, rigid_outputs(setup, setup.robot, real) - setup.reference_output);
}

double guess_along_reference(const EffectDraw& of, const std::function<void(double, Scenario&)>& hide,
                             double small) {
    const PanelSetup& setup = of.setup;
    Scenario scenario = setup.scenario;
    hide(small, scenario);
    const Robot real = with_payloads(real_robot(setup.robot, scenario.robot_errors), scenario);
    const Eigen::MatrixXd changed = rigid_outputs(setup, real, setup.reference);
    const Eigen::MatrixXd believed =
        rigid_outputs(setup, setup.robot, shown(setup.reference, scenario.encoders));
    const double strength = strongest(setup, changed - believed);
    return strength > 1e-9 ? small * of.strength / strength : 0;
}

std::string joint_place(Eigen::Index joint) { return "joint" + std::to_string(joint + 1); }

} // namespace dfdyn::tests
