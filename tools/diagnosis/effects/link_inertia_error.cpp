// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/candidates/point_mass.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <array>

namespace dfdyn::tools {

namespace {

constexpr ParameterKind link_delta_mass{"delta_mass", "kg"};
constexpr std::array link_delta_centre{ParameterKind{"delta_com_x", "m"}, ParameterKind{"delta_com_y", "m"},
                                       ParameterKind{"delta_com_z", "m"}};

/// Error of the mass at the link's centre of mass, of the centre of mass, or of both.
std::vector<Candidate> link_candidates(const DiagnosisSignals& signals, std::size_t number) {
    const auto index = static_cast<Eigen::Index>(number);
    const Eigen::VectorXd nominal = nominal_parameters(signals.robot, signals.kind);
    const Eigen::Index bodies = nominal.size() / 10;
    const double mass = nominal[10 * index];
    const Eigen::Vector3d centre =
        mass > 0 ? Eigen::Vector3d(nominal.segment<3>(10 * index + 1) / mass) : Eigen::Vector3d::Zero();
    Candidate result;
    result.where = numbered("link", signals.link_of(index));
    result.span = index + 1 == bodies ? last_body : "";
    result.columns = mass_columns(signals, index, centre, Eigen::Isometry3d::Identity());
    const auto body = [mass](double delta_mass, const Eigen::VectorXd& moments) {
        constexpr double farthest = 0.3; // m: largest error of a centre of mass
        constexpr double heaviest = 5;   // multiple of the mass in the robot's file
        return mass + delta_mass > 0 && mass + delta_mass <= heaviest * mass &&
               moments.norm() <= farthest * (mass + delta_mass);
    };
    result.shapes = {
        {{0}, [body](const Eigen::VectorXd& c) { return body(c[0], Eigen::VectorXd::Zero(3)); }, 0},
        {{1, 2, 3}, [body](const Eigen::VectorXd& c) { return body(0, c); }, 0},
        {{0, 1, 2, 3}, [body](const Eigen::VectorXd& c) { return body(c[0], c.tail(3)); }, 0, 3}};
    result.parameters = [mass](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        const bool with_mass = shape.columns.front() == 0;
        const double delta_mass = with_mass ? coefficients[0] : 0;
        std::vector values{link_delta_mass.at(delta_mass)};
        for (Eigen::Index axis = 0; axis < 3 && shape.columns.size() > 1; ++axis) {
            values.push_back(link_delta_centre[static_cast<std::size_t>(axis)].at(
                coefficients[axis + (with_mass ? 1 : 0)] / (mass + delta_mass)));
        }
        return values;
    };
    return {std::move(result)};
}

/// Changes the mass and the position of the link's centre of mass in the model.
EffectDisposition extend_by_link(ModelExtension& extension, const ChosenEffect& chosen) {
    auto parameters = extension.body(chosen.number());
    const bool with_mass = chosen.shape.columns.front() == 0;
    const double mass = parameters[0];
    const double found_mass = mass + (with_mass ? chosen.coefficients[0] : 0);
    const Eigen::Vector3d centre =
        mass > 0 ? Eigen::Vector3d(parameters.segment<3>(1) / mass) : Eigen::Vector3d::Zero();
    const Eigen::Vector3d moment = chosen.coefficients.size() > 1
                                       ? Eigen::Vector3d(chosen.coefficients.tail<3>())
                                       : Eigen::Vector3d::Zero();
    if (!(found_mass > 0)) {
        return EffectDisposition::left_out;
    }
    parameters += point_mass(found_mass, centre + moment / found_mass) - point_mass(mass, centre);
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
