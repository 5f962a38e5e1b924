// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/sliding.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

namespace {

constexpr ParameterKind coulomb_level{"coulomb", "N·m"};
constexpr ParameterKind coulomb_forward{"coulomb_pos", "N·m"};
constexpr ParameterKind coulomb_backward{"coulomb_neg", "N·m"};

/// One friction level for both directions, or one for each.
std::vector<Candidate> coulomb_candidates(const DiagnosisSignals& signals, std::size_t number) {
    const JointSignals joint(signals, number);
    Candidate result = joint.candidate();
    result.family = sliding_family(joint);
    for (Eigen::VectorXd& direction : sliding_directions(joint)) {
        result.shapes.push_back({{result.columns.size()}, is_positive, 0});
        result.columns.push_back(joint.column(std::move(direction)));
    }
    result.columns.push_back(joint.column(joint.direction.array().square().matrix()));
    for (std::size_t i = 0; i < 3; ++i) {
        result.shapes.push_back({{i, 3}, first_is_positive, 0});
    }
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        if (shape.columns.size() == 1) {
            return std::vector{coulomb_level.at(coefficients[0])};
        }
        return std::vector{coulomb_forward.at(coefficients[0] + coefficients[1]),
                           coulomb_backward.at(coefficients[0] - coefficients[1])};
    };
    return {std::move(result)};
}

/// Two levels are equivalent to one level and an offset.
EffectDisposition extend_by_coulomb(ModelExtension& extension, const ChosenEffect& chosen) {
    if (chosen.coefficients.size() == 2) {
        add_column(extension, chosen, on_joint(chosen, effect_kinds::torque_offset), 1);
    }
    return add_single(extension, chosen, effect_kinds::coulomb_friction);
}

} // namespace

Effect effects::coulomb_friction() {
    return {.name = "coulomb_friction",
            .where = "jointK",
            .parameters = {coulomb_level, coulomb_forward, coulomb_backward},
            .evidence = "keeps its size and changes sign with the direction of motion",
            .experiment = "move this joint alone slowly at constant speed in both directions: the torques "
                          "differ by twice this value",
            .in_extended_model = "adapting (two levels: a level and an offset)",
            .friction = true,
            .textbook = TextbookTerm::dry,
            .each = Each::torque_joint,
            .candidates = coulomb_candidates,
            .plotted_over = over_velocity,
            .extend = extend_by_coulomb};
}

} // namespace dfdyn::tools
