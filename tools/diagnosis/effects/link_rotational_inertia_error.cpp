// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/inertia.hpp"

#include <algorithm>
#include <array>

namespace dfdyn::tools {

namespace {

constexpr std::array kinds{ParameterKind{"delta_ixx", "kg·m²"}, ParameterKind{"delta_iyy", "kg·m²"},
                           ParameterKind{"delta_izz", "kg·m²"}, ParameterKind{"delta_ixy", "kg·m²"},
                           ParameterKind{"delta_ixz", "kg·m²"}, ParameterKind{"delta_iyz", "kg·m²"}};
/// Their places among the ten inertial parameters of a body.
constexpr std::array<Eigen::Index, kinds.size()> place_of_kind{4, 7, 9, 5, 6, 8};

/// Returns the ten inertial parameters of a change that moves no mass.
InertialParameters as_parameters(const CentralInertia& change) {
    InertialParameters result = InertialParameters::Zero();
    result(place_of_kind) = change;
    return result;
}

/// Returns the change by a shape. Column 0 scales the inertia `nominal`; columns 1 to 6 change one element.
CentralInertia change_of(const CentralInertia& nominal, const Eigen::VectorXd& coefficients,
                         const EffectShape& shape) {
    CentralInertia change = CentralInertia::Zero();
    for (Eigen::Index i = 0; i < coefficients.size(); ++i) {
        const std::size_t column = shape.columns[static_cast<std::size_t>(i)];
        if (column == 0) {
            change += coefficients[i] * nominal;
        } else {
            change[static_cast<Eigen::Index>(column) - 1] = coefficients[i];
        }
    }
    return change;
}

/// Returns the distance (m) from the link's centre of mass within which its mass is: to the farther of its
/// two joints, and a housing around it. A larger inertia is that of a rotor behind a gear, not of a link.
double reach_of_link(const Robot& robot, std::size_t link, const InertialParameters& body) {
    constexpr double housing = 0.05; // m
    const Eigen::Vector3d next = link + 1 < robot.joints.size()
                                     ? robot.joints[link + 1].placement.translation()
                                     : robot.tip_placement.translation();
    const Eigen::Vector3d centre = central_body(body).centre;
    return std::max(centre.norm(), (next - centre).norm()) + housing;
}

/// Returns the second moment of the mass' distance from its centre (kg·m²).
double second_moment(const InertialParameters& body) { return central_inertia(body).head<3>().sum() / 2; }

/// Returns whether a body within this distance from its centre can have these parameters, or one as large as
/// that of the robot's file.
bool is_link(const InertialParameters& body, double reach, const InertialParameters& nominal) {
    const double largest = std::max(reach * reach * body[0], second_moment(nominal));
    return body[0] > 0 && second_moment(body) <= largest && !inertia_fault(body);
}

/// Returns the number of outputs on which a column acts.
auto acts_on(const EffectColumn& column) {
    return std::ranges::count_if(column.parts,
                                 [](const EffectColumn::Part& part) { return !part.series.isZero(1e-9); });
}

/// Returns the shapes of these columns, without rules: the scale, the moments, moments and products, each
/// without columns that act on nothing. Empty if no column acts on more than one output: a rotor's inertia
/// does the same there.
std::vector<EffectShape> shapes_of(const std::vector<EffectColumn>& columns) {
    std::vector<EffectShape> shapes;
    if (std::ranges::none_of(columns, [](const EffectColumn& column) { return acts_on(column) > 1; })) {
        return shapes;
    }
    for (const std::vector<std::size_t>& wanted :
         {std::vector<std::size_t>{0}, {1, 2, 3}, {1, 2, 3, 4, 5, 6}}) {
        EffectShape shape{.columns = wanted, .allowed = {}};
        std::erase_if(shape.columns, [&](std::size_t column) { return acts_on(columns[column]) == 0; });
        const bool is_new = shapes.empty() || shapes.back().columns != shape.columns;
        if (!shape.columns.empty() && is_new) {
            shapes.push_back(std::move(shape));
        }
    }
    return shapes;
}

std::vector<Candidate> inertia_candidates(const DiagnosisSignals& signals, std::size_t number) {
    const auto index = static_cast<Eigen::Index>(number);
    const InertialParameters body = nominal_parameters(signals.robot, signals.kind).segment<10>(10 * index);
    const CentralInertia nominal = central_inertia(body);
    const std::size_t link = signals.link_of(index);
    const double reach = reach_of_link(signals.robot, link, body);
    Candidate result;
    result.where = place_text(PlaceKind::link, link);
    result.columns.push_back(on_outputs(signals.of_body(index, as_parameters(nominal))));
    for (Eigen::Index kind = 0; kind < CentralInertia::SizeAtCompileTime; ++kind) {
        result.columns.push_back(
            on_outputs(signals.of_body(index, as_parameters(CentralInertia::Unit(kind)))));
    }
    result.shapes = shapes_of(result.columns);
    if (result.shapes.empty()) {
        return {};
    }
    for (EffectShape& shape : result.shapes) {
        shape.allowed = [body, nominal, reach, own = shape](const Eigen::VectorXd& coefficients) {
            return is_link(body + as_parameters(change_of(nominal, coefficients, own)), reach, body);
        };
    }
    result.parameters = [nominal](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        const CentralInertia change = change_of(nominal, coefficients, shape);
        std::vector<EffectParameter> values;
        for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
            values.push_back(kinds[kind].at(change[static_cast<Eigen::Index>(kind)]));
        }
        return values;
    };
    return {std::move(result)};
}

EffectDisposition extend_by_inertia(ModelExtension& extension, const ChosenEffect& chosen) {
    CentralInertia change;
    std::ranges::transform(chosen.candidate.parameters(chosen.coefficients, chosen.shape), change.begin(),
                           &EffectParameter::value);
    extension.body(chosen.number()) += as_parameters(change);
    return EffectDisposition::adapting;
}

} // namespace

Effect effects::link_rotational_inertia_error() {
    return {.name = "link_rotational_inertia_error",
            .where = "linkK",
            .parameters = {kinds.begin(), kinds.end()},
            .remark = ": about the centre of mass",
            .evidence = "is that of moments of inertia that differ from the model's, at the same mass",
            .experiment =
                "turn this link quickly about each of its axes, also with joints before it, and the "
                "joint alone; compare the moments in the robot's file with those of a body of the "
                "link's mass and size",
            .in_extended_model = "adapting: the rigid body's parameters start there",
            .yields = true,
            .each = Each::body,
            .candidates = inertia_candidates,
            .extend = extend_by_inertia};
}

} // namespace dfdyn::tools
