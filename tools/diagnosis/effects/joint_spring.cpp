// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/sliding.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

namespace {

constexpr ParameterKind spring_stiffness{"stiffness", "N·m/rad"};
constexpr ParameterKind spring_rest{"rest", "rad"};

std::vector<Candidate> spring_candidates(const DiagnosisSignals& signals, std::size_t number) {
    const JointSignals joint(signals, number);
    Candidate result = joint.candidate();
    result.columns = {joint.column(joint.position),
                      joint.column(Eigen::VectorXd::Ones(joint.position.size()))};
    result.shapes = {{{0, 1}, first_is_positive, 0}};
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector{spring_stiffness.at(coefficients[0]),
                           spring_rest.at(-coefficients[1] / coefficients[0])};
    };
    return {std::move(result)};
}

} // namespace

Effect effects::joint_spring() {
    return {.name = "joint_spring",
            .where = "jointK",
            .parameters = {spring_stiffness, spring_rest},
            .evidence = "is in proportion to the joint's position",
            .experiment = "hold this joint at several angles with its axis vertical, where gravity plays no "
                          "part",
            .in_extended_model = "adapting",
            .each = Each::torque_joint,
            .candidates = spring_candidates,
            .plotted_over = over_position,
            .extend = [](ModelExtension& extension, const ChosenEffect& chosen) {
                add_column(extension, chosen, on_joint(chosen, effect_kinds::torque_offset), 1);
                return add_single(extension, chosen, effect_kinds::joint_spring);
            }};
}

} // namespace dfdyn::tools
