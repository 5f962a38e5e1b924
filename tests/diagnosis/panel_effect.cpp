// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel_effect.hpp"

#include "tools/common/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

enum class Shows { torque, wrench, both };

struct CatalogueEntry {
    const char* name;
    Shows shows;
    std::optional<DrawnEffect> (*draw)(const std::string& name, const EffectDraw& of);
};

constexpr std::array<CatalogueEntry, 25> catalogue{{
    {"viscous_friction", Shows::torque, draw_friction_effect},
    {"coulomb_friction", Shows::torque, draw_friction_effect},
    {"stribeck_friction", Shows::torque, draw_friction_effect},
    {"load_dependent_friction", Shows::torque, draw_friction_effect},
    {"presliding_hysteresis", Shows::torque, draw_friction_effect},
    {"torque_offset", Shows::torque, draw_sensor_effect},
    {"rotor_inertia", Shows::torque, draw_joint_effect},
    {"joint_spring", Shows::torque, draw_joint_effect},
    {"torque_ripple", Shows::torque, draw_joint_effect},
    {"backlash", Shows::both, draw_gear_effect},
    {"joint_flexibility", Shows::both, draw_gear_effect},
    {"actuator_gain", Shows::torque, draw_sensor_effect},
    {"payload", Shows::both, draw_body_effect},
    {"link_inertia_error", Shows::both, draw_body_effect},
    {"gravity_tilt", Shows::both, draw_body_effect},
    {"ft_bias", Shows::wrench, draw_sensor_effect},
    {"ft_drift", Shows::wrench, draw_sensor_effect},
    {"ft_gain", Shows::wrench, draw_sensor_effect},
    {"ft_crosstalk", Shows::wrench, draw_sensor_effect},
    {"ft_rotation", Shows::wrench, draw_sensor_effect},
    {"encoder_offset", Shows::both, draw_body_effect},
    {"encoder_eccentricity", Shows::both, draw_body_effect},
    {"delay", Shows::both, draw_sensor_effect},
    {"friction_drift", Shows::torque, draw_friction_effect},
    {"external_contact", Shows::both, draw_joint_effect},
}};

/// The body that payloads add, whenever they are attached.
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

/// What the encoders show of a motion.
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

std::vector<std::string> panel_effect_names() {
    std::vector<std::string> names;
    for (const CatalogueEntry& entry : catalogue) {
        names.emplace_back(entry.name);
    }
    return names;
}

bool shows(const std::string& effect, OutputKind outputs, bool constants_known) {
    const auto* const entry = std::ranges::find(catalogue, effect, &CatalogueEntry::name);
    if (entry == catalogue.end()) {
        return outputs != OutputKind::wrench; // outside of it: all on the joints
    }
    if (effect == "actuator_gain" && !constants_known) {
        return false;
    }
    return entry->shows == Shows::both || (entry->shows == Shows::wrench) == (outputs == OutputKind::wrench);
}

std::optional<DrawnEffect> draw_effect(const std::string& name, const EffectDraw& of) {
    if (!shows(name, of.setup.kind.outputs, of.setup.constants_known)) {
        return std::nullopt;
    }
    const auto* const entry = std::ranges::find(catalogue, name, &CatalogueEntry::name);
    std::optional<DrawnEffect> drawn =
        entry == catalogue.end() ? draw_outside_effect(name, of) : entry->draw(name, of);
    if (!drawn) {
        throw InputError("effect: expected one of the catalogue or outside of it, found " + name);
    }
    drawn->effect = name;
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
