// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/effects/panel_effect.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tests {

using namespace tools;

namespace {

DrawnEffect rotor(const EffectDraw& of, Eigen::Index joint) {
    DrawnEffect effect;
    effect.hide = [joint](double size, Scenario& scenario) {
        scenario.actuators.rotor_inertia[joint] = size;
    };
    effect.parameters = [](double size) { return EffectParameters{{"inertia", size}}; };
    effect.guess = of.wanted(joint) / rms(of.setup.reference.acceleration.col(joint));
    effect.largest = 20;
    return effect;
}

DrawnEffect spring(const EffectDraw& of, Eigen::Index joint) {
    const Eigen::VectorXd position = of.setup.reference.position.col(joint);
    const double rest = of.draw.uniform(position.minCoeff(), position.maxCoeff());
    DrawnEffect effect;
    effect.hide = [joint, rest](double size, Scenario& scenario) {
        const JointVector zero = JointVector::Zero(scenario.actuators.rotor_inertia.size());
        JointSprings springs = scenario.loads.springs.value_or(JointSprings{zero, zero});
        springs.stiffness[joint] = size;
        springs.rest[joint] = rest;
        scenario.loads.springs = springs;
    };
    effect.parameters = [rest](double size) { return EffectParameters{{"stiffness", size}, {"rest", rest}}; };
    effect.guess = of.wanted(joint) / rms((position.array() - rest).matrix());
    effect.largest = 300;
    return effect;
}

DrawnEffect ripple(const EffectDraw& of, Eigen::Index joint) {
    const double cycles = of.draw.whole(2, 12);
    const double phase = of.draw.uniform(-std::numbers::pi, std::numbers::pi);
    DrawnEffect effect;
    effect.hide = [joint, cycles, phase](double size, Scenario& scenario) {
        const JointVector zero = JointVector::Zero(scenario.actuators.rotor_inertia.size());
        TorqueRipple one = scenario.loads.ripple.value_or(TorqueRipple{zero, zero, zero});
        one.amplitude[joint] = size;
        one.cycles[joint] = cycles;
        one.phase[joint] = phase;
        scenario.loads.ripple = one;
    };
    effect.parameters = [cycles, phase](double size) {
        return EffectParameters{{"amplitude", size}, {"cycles_per_rev", cycles}, {"phase", phase}};
    };
    effect.guess = of.wanted(joint) * std::numbers::sqrt2;
    effect.largest = 100;
    return effect;
}

struct Pulse {
    double start_s, end_s;

    Contact contact() const {
        Contact contact;
        contact.start_s = start_s;
        contact.end_s = end_s;
        return contact;
    }
    /// Root mean square of a pulse of height 1 over the whole recording.
    double rms(double duration_s) const { return std::sqrt(3.0 / 8 * (end_s - start_s) / duration_s); }
};

Pulse random_pulse(const EffectDraw& of) {
    const double lasts = of.draw.uniform(0.8, 5);
    const double start = of.draw.uniform(4, of.setup.duration_s - 2 - lasts);
    return {start, start + lasts};
}

DrawnEffect push_on_joint(const EffectDraw& of, Eigen::Index joint) {
    const Pulse pulse = random_pulse(of);
    const double sign = of.draw.sign();
    DrawnEffect effect;
    effect.hide = [joint, pulse, sign](double size, Scenario& scenario) {
        Contact contact = pulse.contact();
        contact.joint = joint;
        contact.peak = sign * size;
        scenario.loads.contacts.push_back(contact);
    };
    effect.parameters = [pulse, sign](double size) {
        return EffectParameters{{"peak", sign * size}, {"start", pulse.start_s}, {"end", pulse.end_s}};
    };
    effect.guess = of.wanted(joint) / pulse.rms(of.setup.duration_s);
    effect.largest = 300;
    return effect;
}

DrawnEffect push_at_tip(const EffectDraw& of) {
    const Pulse pulse = random_pulse(of);
    const double up = of.draw.uniform(-1, 1);
    const double round = of.draw.uniform(-std::numbers::pi, std::numbers::pi);
    const double level = std::sqrt(1 - up * up);
    const Eigen::Vector3d direction(level * std::cos(round), level * std::sin(round), up);
    DrawnEffect effect;
    effect.where = "ft_sensor";
    effect.hide = [pulse, direction](double size, Scenario& scenario) {
        Contact contact = pulse.contact();
        contact.force = size * direction;
        scenario.loads.contacts.push_back(contact);
    };
    effect.parameters = [pulse, direction](double size) {
        return EffectParameters{{"peak", size},
                                {"start", pulse.start_s},
                                {"end", pulse.end_s},
                                {"base_x", direction.x()},
                                {"base_y", direction.y()},
                                {"base_z", direction.z()}};
    };
    effect.guess = of.strength * of.setup.noise_in_band.head(3).minCoeff() / pulse.rms(of.setup.duration_s);
    effect.largest = 200;
    return effect;
}

DrawnEffect at_joint(const EffectDraw& of, DrawnEffect (*draw)(const EffectDraw&, Eigen::Index)) {
    const Eigen::Index joint = of.joint();
    DrawnEffect effect = draw(of, joint);
    effect.where = joint_place(joint);
    return effect;
}

} // namespace

namespace hidden_effects {

DrawnEffect rotor_inertia(const EffectDraw& of) { return at_joint(of, rotor); }
DrawnEffect joint_spring(const EffectDraw& of) { return at_joint(of, spring); }
DrawnEffect torque_ripple(const EffectDraw& of) { return at_joint(of, ripple); }
DrawnEffect external_contact(const EffectDraw& of) {
    return of.setup.wrench() ? push_at_tip(of) : at_joint(of, push_on_joint);
}

} // namespace hidden_effects

} // namespace dfdyn::tests
