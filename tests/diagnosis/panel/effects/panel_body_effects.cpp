// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/effects/panel_effect.hpp"
#include "tools/robot/inertia.hpp"

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

/// m²: moment of inertia of a link whose mass is 0.14 m from its centre, divided by its mass
constexpr double reach_squared = 0.02;

/// Returns the moments of inertia of a box with random edges, divided by the largest possible one.
Eigen::Vector3d draw_box(Draw& draw) {
    const Eigen::Array3d squares =
        Eigen::Array3d(draw.uniform(0.2, 1), draw.uniform(0.2, 1), draw.uniform(0.2, 1)).square();
    return (squares.sum() - squares) / squares.sum();
}

/// The link has moments of inertia that the robot's file lacks: those of a box. Where the file has those of a
/// larger body, a placeholder, the link has less: a share of them is missing.
DrawnEffect link_moments(const EffectDraw& of, std::size_t link) {
    const InertialParameters& body = of.setup.robot.joints[link].inertia;
    const Eigen::Vector3d nominal = central_body(body).inertia.diagonal();
    const bool placeholder = nominal.sum() / 2 > reach_squared * body[0];
    const Eigen::Vector3d change = placeholder ? Eigen::Vector3d(-nominal) : draw_box(of.draw);
    DrawnEffect effect;
    effect.hide = [link, change](double size, Scenario& scenario) {
        scenario.robot_errors.links.push_back({link, 0, Eigen::Vector3d::Zero(), size * change});
    };
    effect.parameters = [change](double size) {
        return largest_first({{"delta_ixx", size * change.x()},
                              {"delta_iyy", size * change.y()},
                              {"delta_izz", size * change.z()}});
    };
    effect.guess = guess_along_reference(of, effect.hide, 1e-3);
    effect.largest = placeholder ? 0.9 : reach_squared * body[0];
    return effect;
}

/// Gives an effect to a link from `least` on. With an F/T sensor the whole link is beyond it; if there is
/// none, the effect has no size.
DrawnEffect at_link(const EffectDraw& of, std::size_t least,
                    DrawnEffect (*draw)(const EffectDraw&, std::size_t link)) {
    const Robot& robot = of.setup.robot;
    const std::size_t first = of.setup.wrench() ? std::max(robot.sensor->link, least) : least;
    if (first >= robot.joints.size()) {
        return {};
    }
    const std::size_t link = first + of.draw.below(robot.joints.size() - first);
    DrawnEffect effect = draw(of, link);
    effect.where = "link" + std::to_string(link + 1);
    return effect;
}

DrawnEffect mass_or_centre(const EffectDraw& of, std::size_t link) {
    return of.draw.chance(0.5) ? link_mass(of, link) : link_centre(of, link);
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
DrawnEffect link_inertia_error(const EffectDraw& of) { return at_link(of, 0, mass_or_centre); }
/// The first link's inertia is that of its joint's rotor as well.
DrawnEffect link_rotational_inertia_error(const EffectDraw& of) { return at_link(of, 1, link_moments); }
DrawnEffect gravity_tilt(const EffectDraw& of) { return tilt(of); }
DrawnEffect encoder_offset(const EffectDraw& of) { return at_encoder(of, shifted_zero); }
DrawnEffect encoder_eccentricity(const EffectDraw& of) { return at_encoder(of, eccentricity); }

} // namespace hidden_effects

} // namespace dfdyn::tests
