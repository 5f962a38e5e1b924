// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/joint_units.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Returns whether a place is at a prismatic joint: its joint, encoder or actuator.
bool at_prismatic_joint(const std::string& where, const Robot& robot) {
    constexpr std::array of_joints{"joint", "encoder", "actuator"};
    const std::size_t digits = where.find_first_of("0123456789");
    return digits != std::string::npos &&
           std::ranges::find(of_joints, where.substr(0, digits)) != of_joints.end() &&
           robot.joints.at(std::stoul(where.substr(digits)) - 1).prismatic;
}

} // namespace

std::string unit_at_joint(const std::string& unit, bool prismatic) {
    static constexpr std::array<std::pair<const char*, const char*>, 9> units{{{"N·m·s/rad", "N·s/m"},
                                                                               {"N·m/rad", "N/m"},
                                                                               {"N·m/A", "N/A"},
                                                                               {"N·m/s", "N/s"},
                                                                               {"N·m", "N"},
                                                                               {"rad/s²", "m/s²"},
                                                                               {"rad/s", "m/s"},
                                                                               {"rad", "m"},
                                                                               {"kg·m²", "kg"}}};
    const auto* const found =
        std::ranges::find_if(units, [&](const auto& entry) { return unit == entry.first; });
    return prismatic && found != units.end() ? found->second : unit;
}

void set_output_units(Diagnosis& diagnosis, const Robot& robot, OutputKind outputs) {
    diagnosis.output_units.clear();
    diagnosis.torque_units.clear();
    for (std::size_t output = 0; output < diagnosis.output_names.size(); ++output) {
        const bool force = outputs == OutputKind::wrench ? output < 3 : robot.joints.at(output).prismatic;
        diagnosis.torque_units.emplace_back(force ? "N" : "N·m");
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
