// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension/corrected_robot.hpp"

#include "tools/base/text/number.hpp"
#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/model/effects.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace dfdyn::tools {

namespace {

/// Member of the joint that holds a column's coefficient; null if there is none.
double JointDynamics::*member_of(const std::string& effect) {
    if (effect == effect_kinds::viscous_friction.name) {
        return &JointDynamics::damping;
    }
    if (effect == effect_kinds::coulomb_friction.name) {
        return &JointDynamics::friction;
    }
    return effect == effect_kinds::rotor_inertia.name ? &JointDynamics::armature : nullptr;
}

/// The link's parameters with the correction. At an F/T sensor only the part beyond it was measured.
InertialParameters corrected_link(const ModelExtension& extension, std::size_t link,
                                  const InertialParameters& found) {
    const RobotJoint& joint = extension.robot.joints[link];
    const bool divided = extension.kind == OutputKind::wrench && extension.robot.sensor &&
                         extension.robot.sensor->link == link + 1;
    return divided ? InertialParameters(joint.inertia - extension.robot.sensor->inertia_beyond + found)
                   : found;
}

void correct_links(RobotExport& result, const ModelExtension& extension) {
    const auto bodies = static_cast<std::size_t>(extension.bodies.size() / 10);
    const std::size_t first = extension.robot.joints.size() - bodies;
    for (std::size_t body = 0; body < bodies; ++body) {
        const InertialParameters link = corrected_link(
            extension, first + body, extension.bodies.segment<10>(10 * static_cast<Eigen::Index>(body)));
        if (const auto fault = inertia_fault(link)) {
            result.left_out.push_back(place_text(PlaceKind::link, first + body) + " as found: " + *fault);
        } else {
            result.robot.joints[first + body].inertia = link;
        }
    }
}

std::string output_place(OutputKind kind, std::size_t output) {
    return kind == OutputKind::wrench ? "ft_sensor" : place_text(PlaceKind::joint, output);
}

std::string text_of(const ExtensionColumn& column, OutputKind kind) {
    return column.effect.name + " at " + output_place(kind, static_cast<std::size_t>(column.effect.row));
}

/// Returns whether least squares of each joint determine a finding that the causes leave out.
bool has_column(const ModelExtension& extension, const ExtendedFinding& carried) {
    return std::ranges::any_of(extension.columns, [&](const ExtensionColumn& column) {
        return text_of(column, extension.kind) == carried.effect + " at " + carried.where;
    });
}

/// Lists the rigid body's factors that plain least squares found: a robot has masses, and no gains.
void list_gains(RobotExport& result, const ModelExtension& extension) {
    constexpr double noticeable = 1e-3;
    for (Eigen::Index output = 0; output < extension.least_squares_gain.size(); ++output) {
        const double gain = extension.least_squares_gain[output];
        if (std::abs(gain - 1) >= noticeable) {
            result.left_out.push_back("factor " + rounded_text(gain) + " of the rigid body at " +
                                      output_place(extension.kind, static_cast<std::size_t>(output)));
        }
    }
}

/// Returns the name of a format as in a sentence: `URDF`.
std::string title_of(const RobotFormat& format) {
    std::string title = format.name;
    std::ranges::transform(title, title.begin(),
                           [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
    return title;
}

/// Lists the size of gravity for a format that contains none, if simulators would assume another one.
void list_gravity(RobotExport& result, const RobotFormat& format) {
    constexpr double usual = 9.81; // m/s²
    constexpr double noticeable = 0.01;
    const double size = result.robot.gravity.norm();
    if (std::abs(size - usual) > noticeable) {
        result.left_out.push_back("gravity of " + rounded_text(size) + " m/s² in a " + title_of(format) +
                                  ": simulators use 9.81");
    }
}

} // namespace

RobotExport corrected_robot(const ModelExtension& extension, const std::vector<std::string>& formats) {
    RobotExport result{extension.robot, std::vector<JointDynamics>(extension.robot.joints.size()), {}};
    correct_links(result, extension);
    for (const ExtensionColumn& column : extension.columns) {
        double JointDynamics::*const member = member_of(column.effect.name);
        const auto joint = static_cast<std::size_t>(column.effect.row);
        if (member != nullptr && column.value >= 0) {
            result.joints[joint].*member += extension.least_squares_gain[column.effect.row] * column.value;
        } else {
            result.left_out.push_back(text_of(column, extension.kind));
        }
    }
    for (const ExtendedFinding& carried : extension.carried) {
        if (carried.how == EffectDisposition::left_out && !has_column(extension, carried)) {
            result.left_out.push_back(carried.effect + " at " + carried.where);
        }
    }
    list_gains(result, extension);
    for (const RobotFormat& format : robot_formats()) {
        if (!format.holds_gravity && std::ranges::find(formats, format.name) != formats.end()) {
            list_gravity(result, format);
        }
    }
    std::vector<std::string>& names = result.left_out; // the axes of a sensor have the same
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return result;
}

} // namespace dfdyn::tools
