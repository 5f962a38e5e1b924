// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/joint_units.hpp"

#include "tools/robot/joint_unit.hpp"

#include <algorithm>
#include <array>

namespace dfdyn::tools {

namespace {

/// Returns whether a place is at a prismatic joint: its joint, encoder or actuator.
bool at_prismatic_joint(const std::string& where, const Robot& robot) {
    constexpr std::array of_joints{PlaceKind::joint, PlaceKind::encoder, PlaceKind::actuator};
    const std::optional<Place> place = numbered_place(where);
    return place && std::ranges::find(of_joints, place->kind) != of_joints.end() &&
           robot.joints.at(place->index).prismatic;
}

} // namespace

std::string torque_unit(const Robot& robot, bool wrench, std::size_t output) {
    return unit_at_joint("N·m", wrench ? output < 3 : robot.joints.at(output).prismatic);
}

void set_output_units(Diagnosis& diagnosis, const Robot& robot, OutputKind outputs) {
    diagnosis.output_units.clear();
    diagnosis.torque_units.clear();
    for (std::size_t output = 0; output < diagnosis.output_names.size(); ++output) {
        diagnosis.torque_units.push_back(torque_unit(robot, outputs == OutputKind::wrench, output));
        diagnosis.output_units.push_back(
            outputs == OutputKind::motor_current ? "A" : diagnosis.torque_units.back());
    }
}

void use_units_of_joints(Diagnosis& diagnosis, const Robot& robot) {
    for (Finding& finding : diagnosis.findings) {
        const bool prismatic = at_prismatic_joint(finding.where, robot);
        for (FoundParameter& parameter : finding.parameters) {
            const bool angle = parameter.name == "phase"; // at every joint
            parameter.unit = unit_at_joint(parameter.unit, prismatic && !angle);
        }
    }
    for (NuisanceEstimate& nuisance : diagnosis.nuisance_estimates) {
        nuisance.parameter.unit =
            unit_at_joint(nuisance.parameter.unit, at_prismatic_joint(nuisance.where, robot));
    }
}

} // namespace dfdyn::tools
