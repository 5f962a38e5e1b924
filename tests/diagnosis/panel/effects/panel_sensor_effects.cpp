// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/effects/panel_effect.hpp"

#include "tests/diagnosis/panel/recording/panel_band.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

const std::vector<std::string> axes{"fx", "fy", "fz", "mx", "my", "mz"};

JointVector per_joint(const Scenario& scenario, const std::optional<JointVector>& values, double otherwise) {
    return values.value_or(JointVector::Constant(scenario.actuators.rotor_inertia.size(), otherwise));
}

DrawnEffect constant_torque(const EffectDraw& of, Eigen::Index joint) {
    const double sign = of.draw.sign();
    DrawnEffect effect;
    effect.where = joint_place(joint);
    effect.hide = [joint, sign](double size, Scenario& scenario) {
        JointVector offset = per_joint(scenario, scenario.torque_sensor.offset, 0);
        offset[joint] = sign * size;
        scenario.torque_sensor.offset = offset;
    };
    effect.parameters = [sign](double size) { return EffectParameters{{"offset", sign * size}}; };
    effect.guess = of.wanted(joint);
    effect.largest = 100;
    return effect;
}

DrawnEffect wrong_constant(const EffectDraw& of, Eigen::Index joint) {
    const double sign = of.draw.sign();
    DrawnEffect effect;
    effect.where = "actuator" + std::to_string(joint + 1);
    effect.hide = [joint, sign](double size, Scenario& scenario) {
        JointVector gain = per_joint(scenario, scenario.torque_sensor.gain, 1);
        gain[joint] = 1 + sign * size;
        scenario.torque_sensor.gain = gain;
    };
    effect.parameters = [sign](double size) { return EffectParameters{{"gain", 1 + sign * size}}; };
    effect.guess = of.strength * of.setup.noise_in_band[joint] / rms(of.setup.reference_output.col(joint));
    effect.largest = 0.6;
    return effect;
}

/// Root mean square of the reference output's change per second.
double rate_rms(const PanelSetup& setup, Eigen::Index output) {
    const Eigen::VectorXd column = setup.reference_output.col(output);
    return 50 * rms(column.tail(column.size() - 1) - column.head(column.size() - 1));
}

DrawnEffect late_reading(const EffectDraw& of) {
    DrawnEffect effect;
    effect.parameters = [](double size) { return EffectParameters{{"delay", size}}; };
    effect.largest = 0.15;
    if (of.setup.wrench()) {
        effect.where = "ft_sensor";
        effect.hide = [](double size, Scenario& scenario) { scenario.force_torque->delay_s = size; };
        double fastest = 0;
        for (Eigen::Index axis = 0; axis < 6; ++axis) {
            fastest = std::max(fastest, rate_rms(of.setup, axis) / of.setup.noise_in_band[axis]);
        }
        effect.guess = of.strength / fastest;
        return effect;
    }
    const Eigen::Index joint = of.joint();
    effect.where = "actuator" + std::to_string(joint + 1);
    effect.hide = [joint](double size, Scenario& scenario) {
        JointVector delays = per_joint(scenario, scenario.torque_sensor.delay_s, 0);
        delays[joint] = size;
        scenario.torque_sensor.delay_s = delays;
    };
    effect.guess = of.strength * of.setup.noise_in_band[joint] / rate_rms(of.setup, joint);
    return effect;
}

/// A random pattern over one or all axes in units of their noise; the largest entry is 1.
Wrench pattern(const EffectDraw& of) {
    Wrench result = Wrench::Zero();
    if (of.draw.chance(0.5)) {
        const auto axis = static_cast<Eigen::Index>(of.draw.below(6));
        result[axis] = of.draw.sign() * of.setup.noise_in_band[axis];
        return result;
    }
    const auto main = static_cast<Eigen::Index>(of.draw.below(6));
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
        result[axis] =
            (axis == main ? of.draw.sign() : of.draw.uniform(-0.8, 0.8)) * of.setup.noise_in_band[axis];
    }
    return result;
}

/// Parameters of six axes, sorted by their ratio to the noise.
EffectParameters six(const Wrench& values, const Eigen::VectorXd& noise) {
    Eigen::Index main = 0;
    values.cwiseQuotient(noise).cwiseAbs().maxCoeff(&main);
    EffectParameters parameters{{axes[static_cast<std::size_t>(main)], values[main]}};
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
        if (axis != main && values[axis] != 0) {
            parameters.emplace_back(axes[static_cast<std::size_t>(axis)], values[axis]);
        }
    }
    return parameters;
}

DrawnEffect bias(const EffectDraw& of) {
    const Wrench shape = pattern(of);
    const Eigen::VectorXd noise = of.setup.noise_in_band;
    DrawnEffect effect;
    effect.hide = [shape](double size, Scenario& scenario) { scenario.force_torque->bias = size * shape; };
    effect.parameters = [shape, noise](double size) { return six(size * shape, noise); };
    effect.guess = of.strength;
    effect.largest = 1e3;
    return effect;
}

/// A drift that is zero at the first row.
DrawnEffect drift(const EffectDraw& of) {
    const Wrench shape = pattern(of);
    const Eigen::VectorXd noise = of.setup.noise_in_band;
    DrawnEffect effect;
    effect.hide = [shape](double size, Scenario& scenario) {
        scenario.force_torque->drift_per_s = size * shape;
    };
    effect.parameters = [shape, noise](double size) { return six(size * shape, noise); };
    effect.guess = of.strength * std::sqrt(3.0) / of.setup.duration_s;
    effect.largest = 1e3;
    return effect;
}

DrawnEffect gain(const EffectDraw& of) {
    const auto axis = static_cast<Eigen::Index>(of.draw.below(6));
    const double sign = of.draw.sign();
    DrawnEffect effect;
    effect.hide = [axis, sign](double size, Scenario& scenario) {
        scenario.force_torque->calibration(axis, axis) = 1 + sign * size;
    };
    effect.parameters = [axis, sign](double size) {
        return EffectParameters{{"gain", 1 + sign * size}, {"axis", static_cast<double>(axis)}};
    };
    effect.guess = of.strength * of.setup.noise_in_band[axis] / rms(of.setup.reference_output.col(axis));
    effect.largest = 0.6;
    return effect;
}

DrawnEffect crosstalk(const EffectDraw& of) {
    const auto from = static_cast<Eigen::Index>(of.draw.below(6));
    const Eigen::Index to = (from + of.draw.whole(1, 5)) % 6;
    const double sign = of.draw.sign();
    DrawnEffect effect;
    effect.hide = [from, to, sign](double size, Scenario& scenario) {
        scenario.force_torque->calibration(to, from) = sign * size;
    };
    effect.parameters = [from, to, sign](double size) {
        return EffectParameters{{"gain", sign * size},
                                {"from_axis", static_cast<double>(from)},
                                {"to_axis", static_cast<double>(to)}};
    };
    effect.guess = of.strength * of.setup.noise_in_band[to] / rms(of.setup.reference_output.col(from));
    // Crosstalk from a force to a torque is a lever (m), from a torque to a force its inverse.
    effect.largest = (from < 3) == (to < 3) ? 0.6 : from < 3 ? 0.2 : 5;
    return effect;
}

DrawnEffect rotation(const EffectDraw& of) {
    Eigen::Vector3d axis(of.draw.uniform(-1, 1), of.draw.uniform(-1, 1), of.draw.uniform(-1, 1));
    axis.normalize();
    DrawnEffect effect;
    effect.hide = [axis](double size, Scenario& scenario) { scenario.force_torque->rotation = size * axis; };
    effect.parameters = [axis](double size) {
        EffectParameters parameters{
            {"roll", size * axis.x()}, {"pitch", size * axis.y()}, {"yaw", size * axis.z()}};
        std::ranges::stable_sort(parameters, [](const auto& one, const auto& other) {
            return std::abs(one.second) > std::abs(other.second);
        });
        return parameters;
    };
    const Eigen::MatrixXd& wrench = of.setup.reference_output;
    const double force = std::sqrt(wrench.leftCols(3).squaredNorm() / static_cast<double>(wrench.rows()));
    effect.guess = of.strength * of.setup.noise_in_band.head(3).minCoeff() / force;
    effect.largest = 0.5;
    return effect;
}

DrawnEffect at_sensor(DrawnEffect effect) {
    effect.where = "ft_sensor";
    return effect;
}

} // namespace

namespace hidden_effects {

DrawnEffect torque_offset(const EffectDraw& of) { return constant_torque(of, of.joint()); }
DrawnEffect actuator_gain(const EffectDraw& of) { return wrong_constant(of, of.joint()); }
DrawnEffect delay(const EffectDraw& of) { return late_reading(of); }
DrawnEffect ft_bias(const EffectDraw& of) { return at_sensor(bias(of)); }
DrawnEffect ft_drift(const EffectDraw& of) { return at_sensor(drift(of)); }
DrawnEffect ft_gain(const EffectDraw& of) { return at_sensor(gain(of)); }
DrawnEffect ft_crosstalk(const EffectDraw& of) { return at_sensor(crosstalk(of)); }
DrawnEffect ft_rotation(const EffectDraw& of) { return at_sensor(rotation(of)); }

} // namespace hidden_effects

} // namespace dfdyn::tests
