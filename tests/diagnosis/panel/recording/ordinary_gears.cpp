// SPDX-License-Identifier: Apache-2.0
// Friction and rotors of all joints at once, as every real arm has them.
#include "tests/diagnosis/panel/effects/panel_effect.hpp"
#include "tests/diagnosis/panel/recording/panel_run.hpp"

namespace dfdyn::tests {

using namespace tools;

namespace {

HiddenEffect at_joint(const std::string& name, Eigen::Index joint, const std::string& parameter,
                      double size) {
    HiddenEffect effect;
    effect.effect = name;
    effect.where = "joint" + std::to_string(joint + 1);
    effect.parameters = {{parameter, size}};
    return effect;
}

/// Adds the friction and the rotor of one gear.
void add_gear(PanelSetup& setup, Eigen::Index joint, Draw& draw) {
    const double inertia = least_inertia(setup, joint);
    const double load = rms(joint_torque(setup, joint));
    const double level = load * draw.log_uniform(0.05, 0.4);
    const double excess = draw.chance(0.3) ? draw.uniform(1.1, 1.6) : 1;
    LuGreParameters& friction = setup.scenario.actuators.friction[static_cast<std::size_t>(joint)];
    friction.coulomb = level;
    friction.breakaway = excess * level;
    friction.stribeck_velocity = draw.log_uniform(0.03, 0.2);
    friction.viscous = level * draw.uniform(0.2, 1.5) / rms(setup.reference.velocity.col(joint));
    const double rotor = inertia * draw.log_uniform(0.1, 1.5);
    add_bristles(friction, excess * level, stiff_bend, inertia + rotor, 1200);
    setup.scenario.actuators.rotor_inertia[joint] = rotor;
    setup.ordinary.push_back(at_joint("coulomb_friction", joint, "coulomb", level));
    setup.ordinary.push_back(at_joint("viscous_friction", joint, "viscous", friction.viscous));
    setup.ordinary.push_back(at_joint("rotor_inertia", joint, "rotor_inertia", rotor));
    if (excess > 1) {
        setup.ordinary.push_back(at_joint("stribeck_friction", joint, "coulomb", level));
    }
}

} // namespace

void add_ordinary_gears(PanelSetup& setup, Draw draw) {
    setup.scenario.integration_rate_hz = 4000; // for the bristles
    for (Eigen::Index joint = 0; joint < setup.joints(); ++joint) {
        add_gear(setup, joint, draw);
    }
    setup.ordinary_outputs = contribution(setup, run_undisturbed(setup), {}, 0);
}

} // namespace dfdyn::tests
