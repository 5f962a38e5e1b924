// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/candidates/point_mass.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

constexpr ParameterKind link_delta_mass{"delta_mass", "kg"};
constexpr std::array link_delta_centre{ParameterKind{"delta_com_x", "m"}, ParameterKind{"delta_com_y", "m"},
                                       ParameterKind{"delta_com_z", "m"}};

constexpr double most_shapes = 3;

/// Returns the shapes that the motion determines, for a link with this mass: an error of the mass at the
/// link's centre of mass, of the centre of mass, or of both.
std::vector<EffectShape> link_shapes(const std::vector<EffectColumn>& columns, double mass) {
    std::vector<EffectShape> shapes = determined_shapes(columns, {{0}, {1, 2, 3}, {0, 1, 2, 3}});
    for (EffectShape& shape : shapes) {
        shape.bounded_count = shape.columns.front() == 0 ? static_cast<double>(shape.columns.size() - 1) : 0;
        shape.allowed = [mass, own = shape](const Eigen::VectorXd& coefficients) {
            constexpr double farthest = 0.3; // m: largest error of a centre of mass
            constexpr double heaviest = 5;   // multiple of the mass in the robot's file
            const MassChange change = mass_change(coefficients, own);
            const double found = mass + change.mass;
            return found > 0 && found <= heaviest * mass && change.moments.norm() <= farthest * found;
        };
    }
    return shapes;
}

std::vector<Candidate> link_candidates(const DiagnosisSignals& signals, std::size_t number) {
    const auto index = static_cast<Eigen::Index>(number);
    const Eigen::VectorXd nominal = nominal_parameters(signals.robot, signals.kind);
    const Eigen::Index bodies = nominal.size() / 10;
    const double mass = nominal[10 * index];
    const Eigen::Vector3d centre =
        mass > 0 ? Eigen::Vector3d(nominal.segment<3>(10 * index + 1) / mass) : Eigen::Vector3d::Zero();
    Candidate result;
    result.where = place_text(PlaceKind::link, signals.link_of(index));
    result.span = index + 1 == bodies ? last_body : "";
    result.columns = mass_columns(signals, index, centre, Eigen::Isometry3d::Identity());
    result.shapes = link_shapes(result.columns, mass);
    // shapes that the motion does not determine do not change the prior of the others
    result.prior_trials = most_shapes / static_cast<double>(result.shapes.size());
    result.parameters = [mass](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        const MassChange change = mass_change(coefficients, shape);
        std::vector values{link_delta_mass.at(change.mass)};
        for (std::size_t axis = 0; axis < link_delta_centre.size(); ++axis) {
            if (has_moment(shape, axis)) {
                values.push_back(link_delta_centre[axis].at(change.moments[static_cast<Eigen::Index>(axis)] /
                                                            (mass + change.mass)));
            }
        }
        return values;
    };
    return {std::move(result)};
}

/// Changes the mass and the position of the link's centre of mass in the model.
EffectDisposition extend_by_link(ModelExtension& extension, const ChosenEffect& chosen) {
    auto parameters = extension.body(chosen.number());
    const MassChange change = mass_change(chosen.coefficients, chosen.shape);
    const double mass = parameters[0];
    const double found_mass = mass + change.mass;
    const Eigen::Vector3d centre =
        mass > 0 ? Eigen::Vector3d(parameters.segment<3>(1) / mass) : Eigen::Vector3d::Zero();
    if (!(found_mass > 0)) {
        return EffectDisposition::left_out;
    }
    parameters += point_mass(found_mass, centre + change.moments / found_mass) - point_mass(mass, centre);
    return EffectDisposition::adapting;
}

} // namespace

Effect effects::link_inertia_error() {
    return {.name = "link_inertia_error",
            .where = "linkK",
            .parameters = {link_delta_mass, link_delta_centre[0], link_delta_centre[1], link_delta_centre[2]},
            .evidence = "is that of a mass, or a centre of mass, that differs from the model's",
            .experiment = "hold the arm still in a dozen postures that turn this link about its own axes; "
                          "weigh the link if it comes off",
            .in_extended_model = "adapting: the rigid body's parameters start there",
            .mass_of_link = true,
            .each = Each::body,
            .candidates = link_candidates,
            .extend = extend_by_link};
}

} // namespace dfdyn::tools
