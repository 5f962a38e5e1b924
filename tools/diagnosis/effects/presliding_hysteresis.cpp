// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/sliding.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

constexpr ParameterKind presliding_stiffness{"stiffness", "N·m/rad"};
constexpr ParameterKind break_away{"break_away", "N·m"};

std::vector<Candidate> presliding_candidates(const DiagnosisSignals& signals, std::size_t number) {
    const JointSignals joint(signals, number);
    Candidate result = joint.candidate();
    result.family = sliding_family(joint);
    for (double distance = 1.4 * shortest_presliding; distance < 0.3; distance *= 1.7) {
        result.shapes.push_back({{result.columns.size()}, is_positive, distance});
        result.columns.push_back(joint.column(dahl(joint, distance)));
    }
    result.at_value = [joint](const EffectShape& /*shape*/, double distance) {
        return joint.column(dahl(joint, distance));
    };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        return std::vector{presliding_stiffness.at(coefficients[0] / shape.value),
                           break_away.at(coefficients[0])};
    };
    return {std::move(result)};
}

/// Plots over the travel since the last reversal, signed by the direction of motion.
PlotAbscissa over_travel(const PlottedFinding& at) {
    const Eigen::VectorXd position = at.signals.measured.motion.position.col(at.joint());
    Eigen::VectorXd travel = Eigen::VectorXd::Zero(position.size());
    for (const Stretch& stretch : at.signals.measured.stretches) {
        double reversal = position[stretch.first];
        for (Eigen::Index row = stretch.first + 1; row < stretch.first + stretch.count; ++row) {
            const double step = position[row] - position[row - 1];
            if (step * (position[row - 1] - reversal) < 0) {
                reversal = position[row - 1];
            }
            travel[row] = position[row] - reversal;
        }
    }
    constexpr double reach = 6; // multiple of the distance over which the friction builds up
    const double distance =
        at.parameter(break_away.name) / std::max(1e-9, at.parameter(presliding_stiffness.name));
    return at.whole(at.named("travel since its last reversal", "rad"),
                    travel.cwiseMax(-reach * distance).cwiseMin(reach * distance));
}

} // namespace

Effect effects::presliding_hysteresis() {
    return {.name = "presliding_hysteresis",
            .where = "jointK",
            .parameters = {presliding_stiffness, break_away},
            .evidence = "builds up over a stretch of travel after each reversal",
            .experiment = "move this joint back and forth with amplitudes below and above the stretch: "
                          "torque over position draws a loop",
            .in_extended_model = "as Coulomb",
            .friction = true,
            .each = Each::torque_joint,
            .candidates = presliding_candidates,
            .plotted_over = over_travel,
            .extend = [](ModelExtension& extension, const ChosenEffect& chosen) {
                add_single(extension, chosen, effect_kinds::coulomb_friction);
                return EffectDisposition::approximated;
            }};
}

} // namespace dfdyn::tools
