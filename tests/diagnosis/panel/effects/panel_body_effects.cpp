// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/effects/panel_effect.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn::tests {

using namespace tools;

namespace {

/// Puts the parameter of largest magnitude first, because it is the one that a diagnosis must find.
EffectParameters largest_first(EffectParameters parameters) {
    std::ranges::stable_sort(parameters, [](const auto& one, const auto& other) {
        return std::abs(one.second) > std::abs(other.second);
    });
    return parameters;
}

DrawnEffect mass_at_tool(const EffectDraw& of) {
    const Eigen::Vector3d centre(of.draw.uniform(-0.1, 0.1), of.draw.uniform(-0.1, 0.1),
                                 of.draw.uniform(-0.1, 0.1));
    const double attached = of.draw.chance(1.0 / 3) ? of.draw.uniform(0.2, 0.7) * of.setup.duration_s : 0;
    DrawnEffect effect;
    effect.where = "tool";
    effect.hide = [centre, attached](double size, Scenario& scenario) {
        scenario.payloads.push_back({attached, size, centre});
    };
    effect.parameters = [centre, attached](double size) {
        return EffectParameters{{"mass", size},
                                {"com_x", centre.x()},
                                {"com_y", centre.y()},
                                {"com_z", centre.z()},
                                {"attached", attached}};
    };
    effect.guess =
        guess_along_reference(of, effect.hide, 0.01) / std::sqrt(1 - attached / of.setup.duration_s);
    effect.largest = 10;
    return effect;
}

DrawnEffect link_mass(const EffectDraw& of, std::size_t link) {
    const double mass = of.setup.robot.joints[link].inertia[0];
    const double sign = of.draw.sign();
    DrawnEffect effect;
    effect.hide = [link, sign](double size, Scenario& scenario) {
        scenario.robot_errors.links.push_back({link, sign * size, Eigen::Vector3d::Zero()});
    };
    effect.parameters = [sign](double size) { return EffectParameters{{"delta_mass", sign * size}}; };
    effect.guess = guess_along_reference(of, effect.hide, 0.01 * mass);
    effect.largest = (sign < 0 ? 0.8 : 3) * mass;
    if (of.setup.masses_off) { // closer to nominal it would be an ordinary mass error
        const double believed = 1 + of.setup.mass_errors[link];
        effect.smallest = std::max(0.0, mass * (sign * (believed * (1 + sign * largest_mass_error) - 1)));
    }
    return effect;
}

DrawnEffect link_centre(const EffectDraw& of, std::size_t link) {
    Eigen::Vector3d direction(of.draw.uniform(-1, 1), of.draw.uniform(-1, 1), of.draw.uniform(-1, 1));
    direction.normalize();
    DrawnEffect effect;
    effect.hide = [link, direction](double size, Scenario& scenario) {
        scenario.robot_errors.links.push_back({link, 0, size * direction});
    };
    effect.parameters = [direction](double size) {
        return largest_first({{"delta_com_x", size * direction.x()},
                              {"delta_com_y", size * direction.y()},
                              {"delta_com_z", size * direction.z()}});
    };
    effect.guess = guess_along_reference(of, effect.hide, 1e-4);
    effect.largest = 0.3;
    return effect;
}

/// Draws an error of a link that has mass and that is beyond the F/T sensor if there is one.
DrawnEffect link_error(const EffectDraw& of) {
    const Robot& robot = of.setup.robot;
    const std::size_t first = of.setup.wrench() ? robot.sensor->link : 0;
    const std::size_t link = first + of.draw.below(robot.joints.size() - first);
    DrawnEffect effect = of.draw.chance(0.5) ? link_mass(of, link) : link_centre(of, link);
    effect.where = "link" + std::to_string(link + 1);
    return effect;
}

DrawnEffect tilt(const EffectDraw& of) {
    const double direction = of.draw.uniform(-std::numbers::pi, std::numbers::pi);
    const double x = std::cos(direction);
    const double y = std::sin(direction);
    DrawnEffect effect;
    effect.where = "base";
    effect.hide = [x, y](double size, Scenario& scenario) {
        scenario.robot_errors.tilt_x = size * x;
        scenario.robot_errors.tilt_y = size * y;
    };
    effect.parameters = [x, y](double size) {
        return largest_first({{"tilt_x", size * x}, {"tilt_y", size * y}});
    };
    effect.guess = guess_along_reference(of, effect.hide, 1e-3);
    effect.largest = 0.5;
    return effect;
}

DrawnEffect shifted_zero(const EffectDraw& of, Eigen::Index joint) {
    const double sign = of.draw.sign();
    DrawnEffect effect;
    effect.hide = [joint, sign](double size, Scenario& scenario) {
        JointVector offset =
            scenario.encoders.offset.value_or(JointVector::Zero(scenario.encoders.eccentricity.size()));
        offset[joint] = sign * size;
        scenario.encoders.offset = offset;
    };
    effect.parameters = [sign](double size) { return EffectParameters{{"offset", sign * size}}; };
    effect.guess = guess_along_reference(of, effect.hide, 1e-3);
    effect.largest = 0.3;
    return effect;
}

DrawnEffect eccentricity(const EffectDraw& of, Eigen::Index joint) {
    const double phase = of.draw.uniform(-std::numbers::pi, std::numbers::pi);
    DrawnEffect effect;
    effect.hide = [joint, phase](double size, Scenario& scenario) {
        scenario.encoders.eccentricity[joint] = size;
        scenario.encoders.eccentricity_phase[joint] = phase;
    };
    effect.parameters = [phase](double size) {
        return EffectParameters{{"amplitude", size}, {"phase", phase}};
    };
    effect.guess = guess_along_reference(of, effect.hide, 1e-3);
    effect.largest = 0.2;
    return effect;
}

DrawnEffect at_encoder(const EffectDraw& of, DrawnEffect (*draw)(const EffectDraw&, Eigen::Index)) {
    const Eigen::Index joint = of.joint();
    DrawnEffect effect = draw(of, joint);
    effect.where = "encoder" + std::to_string(joint + 1);
    return effect;
}

} // namespace

namespace hidden_effects {

DrawnEffect payload(const EffectDraw& of) { return mass_at_tool(of); }
DrawnEffect link_inertia_error(const EffectDraw& of) { return link_error(of); }
DrawnEffect gravity_tilt(const EffectDraw& of) { return tilt(of); }
DrawnEffect encoder_offset(const EffectDraw& of) { return at_encoder(of, shifted_zero); }
DrawnEffect encoder_eccentricity(const EffectDraw& of) { return at_encoder(of, eccentricity); }

} // namespace hidden_effects

} // namespace dfdyn::tests
