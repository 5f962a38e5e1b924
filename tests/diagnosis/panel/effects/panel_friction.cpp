// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/effects/panel_effect.hpp"

#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

double least_inertia(const PanelSetup& setup, Eigen::Index joint) {
    const ArmDynamics dynamics(setup.robot, JointVector::Zero(setup.joints()));
    ArmDynamics::Configuration configuration;
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index row = 0; row < setup.reference.position.rows(); row += 50) {
        dynamics.configure(setup.reference.position.row(row).transpose(), configuration);
        // The inertia of a joint is smallest while the other joints are free.
        const JointMatrix inverse = dynamics.mass_matrix(configuration).inverse();
        least = std::min(least, 1 / inverse(joint, joint));
    }
    return least;
}

namespace {

LuGreParameters& friction_of(Scenario& scenario, Eigen::Index joint) {
    return scenario.actuators.friction[static_cast<std::size_t>(joint)];
}

DrawnEffect viscous(const EffectDraw& of, Eigen::Index joint) {
    DrawnEffect effect;
    effect.hide = [joint](double size, Scenario& scenario) { friction_of(scenario, joint).viscous = size; };
    effect.parameters = [](double size) { return EffectParameters{{"viscous", size}}; };
    effect.guess = of.wanted(joint) / rms(of.setup.reference.velocity.col(joint));
    effect.largest =
        3 * rms(of.setup.reference_output.col(joint)) * of.setup.torque_constants[joint] + effect.guess;
    return effect;
}

DrawnEffect coulomb(const EffectDraw& of, Eigen::Index joint) {
    const double inertia = least_inertia(of.setup, joint);
    const double skew = of.draw.chance(1.0 / 3) ? of.draw.sign() * of.draw.uniform(0.15, 0.5) : 0;
    DrawnEffect effect;
    effect.hide = [joint, inertia, skew](double size, Scenario& scenario) {
        LuGreParameters& friction = friction_of(scenario, joint);
        friction.coulomb = friction.breakaway = size * (1 + skew);
        friction.negative_excess = size * (1 - skew) - friction.coulomb;
        add_bristles(friction, size, stiff_bend, inertia);
    };
    effect.parameters = [skew](double size) {
        EffectParameters parameters{{"coulomb", size}};
        if (skew != 0) {
            parameters.emplace_back("coulomb_pos", size * (1 + skew));
            parameters.emplace_back("coulomb_neg", size * (1 - skew));
        }
        return parameters;
    };
    effect.guess = of.wanted(joint);
    return effect;
}

DrawnEffect stribeck(const EffectDraw& of, Eigen::Index joint) {
    const double inertia = least_inertia(of.setup, joint);
    const double excess = of.draw.uniform(1.4, 2.5);
    const double speed = of.draw.log_uniform(0.05, 0.3);
    DrawnEffect effect;
    effect.hide = [joint, inertia, excess, speed](double size, Scenario& scenario) {
        LuGreParameters& friction = friction_of(scenario, joint);
        friction.coulomb = size;
        friction.breakaway = excess * size;
        friction.stribeck_velocity = speed;
        add_bristles(friction, size * excess, stiff_bend, inertia);
    };
    effect.parameters = [excess, speed](double size) {
        return EffectParameters{{"coulomb", size}, {"static", excess * size}, {"stribeck_velocity", speed}};
    };
    effect.guess = of.wanted(joint);
    return effect;
}

DrawnEffect load_dependent(const EffectDraw& of, Eigen::Index joint) {
    const double inertia = least_inertia(of.setup, joint);
    const double load = rms(of.setup.reference_output.col(joint)) * of.setup.torque_constants[joint];
    DrawnEffect effect;
    effect.hide = [joint, inertia, load](double size, Scenario& scenario) {
        LuGreParameters& friction = friction_of(scenario, joint);
        friction.load_coefficient = size;
        add_bristles(friction, size * load, stiff_bend, inertia);
    };
    effect.parameters = [](double size) { return EffectParameters{{"mu", size}}; };
    effect.guess = of.wanted(joint) / load;
    effect.largest = 0.6;
    return effect;
}

DrawnEffect presliding(const EffectDraw& of, Eigen::Index joint) {
    const double inertia = least_inertia(of.setup, joint);
    const double bend = of.draw.log_uniform(0.03, 0.2);
    DrawnEffect effect;
    effect.hide = [joint, inertia, bend](double size, Scenario& scenario) {
        add_dry_friction(scenario, joint, size, bend, inertia);
    };
    effect.parameters = [bend](double size) {
        return EffectParameters{{"break_away", size}, {"stiffness", size / bend}};
    };
    effect.guess = of.wanted(joint) * 1.1;
    return effect;
}

/// Friction that changes with time; the size is the relative change per second.
DrawnEffect drift(const EffectDraw& of, Eigen::Index joint) {
    const double duration = of.setup.duration_s;
    const double change = of.draw.uniform(0.4, 1.5); // over the whole recording
    const double sign = change < 0.9 ? of.draw.sign() : 1;
    EffectDraw base = of;
    base.strength = of.strength * std::sqrt(12.0) / change;
    const bool is_viscous = of.draw.chance(0.4);
    const DrawnEffect friction = is_viscous ? viscous(base, joint) : coulomb(base, joint);
    const double level = friction.guess;
    DrawnEffect effect;
    effect.hide = [joint, friction, level, sign](double size, Scenario& scenario) {
        friction.hide(level, scenario);
        friction_of(scenario, joint).drift_per_s = sign * size;
    };
    effect.parameters = [sign](double size) { return EffectParameters{{"rate", sign * size}}; };
    effect.guess = change / duration;
    effect.largest = sign < 0 ? 0.95 / duration : 4 / duration;
    effect.drifting_joint = joint;
    effect.drifting = [sign, duration](double size, double time_s, double torque) {
        return torque * (1 + sign * size * duration / 2) / (1 + sign * size * time_s);
    };
    effect.companion = HiddenEffect{is_viscous ? "viscous_friction" : "coulomb_friction", joint_place(joint),
                                    friction.parameters(level), "", 0};
    return effect;
}

} // namespace

void add_bristles(LuGreParameters& friction, double level, double bend, double inertia, double fastest) {
    friction.stiffness = std::min(level / bend, inertia * fastest * fastest);
}

void add_dry_friction(Scenario& scenario, Eigen::Index joint, double level, double bend, double inertia) {
    LuGreParameters& friction = friction_of(scenario, joint);
    friction.coulomb = friction.breakaway = level;
    add_bristles(friction, level, bend, inertia);
}

namespace {

DrawnEffect rubbing(const EffectDraw& of, DrawnEffect (*draw)(const EffectDraw&, Eigen::Index)) {
    const Eigen::Index joint = of.joint();
    DrawnEffect effect = draw(of, joint);
    effect.where = joint_place(joint);
    if (effect.largest == 0) {
        // A controller cannot follow with friction beyond the torque of the joint's own motion.
        const double own = rms(of.setup.reference_output.col(joint)) * of.setup.torque_constants[joint];
        effect.largest = 3 * own + 2 * effect.guess;
    }
    return effect;
}

} // namespace

namespace hidden_effects {

DrawnEffect viscous_friction(const EffectDraw& of) { return rubbing(of, viscous); }
DrawnEffect coulomb_friction(const EffectDraw& of) { return rubbing(of, coulomb); }
DrawnEffect stribeck_friction(const EffectDraw& of) { return rubbing(of, stribeck); }
DrawnEffect load_dependent_friction(const EffectDraw& of) { return rubbing(of, load_dependent); }
DrawnEffect presliding_hysteresis(const EffectDraw& of) { return rubbing(of, presliding); }
DrawnEffect friction_drift(const EffectDraw& of) { return rubbing(of, drift); }

} // namespace hidden_effects

} // namespace dfdyn::tests
