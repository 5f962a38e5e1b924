// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/sliding.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

namespace {

constexpr ParameterKind stribeck_coulomb{"coulomb", "N·m"};
constexpr ParameterKind stribeck_static{"static", "N·m"};
constexpr ParameterKind stribeck_velocity{"stribeck_velocity", "rad/s"};

/// Requires static friction at least a tenth above the Coulomb friction. A smaller excess is within the error
/// of a Coulomb model and is not an effect of its own.
bool is_stribeck(const Eigen::VectorXd& coefficients) {
    constexpr double least_excess = 0.1;
    return coefficients[0] > 0 && coefficients[1] >= least_excess * coefficients[0];
}

std::vector<Candidate> stribeck_candidates(const DiagnosisSignals& signals, std::size_t number) {
    const JointSignals joint(signals, number);
    Candidate result = joint.candidate();
    result.family = sliding_family(joint);
    const std::vector<Eigen::VectorXd> sliding = sliding_directions(joint);
    const auto faded = [sliding, joint](std::size_t direction, double velocity) {
        return joint.column(sliding[direction].array() *
                            (-(joint.velocity.array() / velocity).square()).exp());
    };
    for (const Eigen::VectorXd& direction : sliding) {
        result.columns.push_back(joint.column(direction));
    }
    const double slowest = joint.all.sign_velocity[joint.output];
    for (const double velocity : {0.01, 0.02, 0.04, 0.08, 0.16, 0.32}) {
        for (std::size_t i = 0; i < sliding.size() && velocity > 1.5 * slowest; ++i) {
            result.shapes.push_back({{i, result.columns.size()}, is_stribeck, velocity});
            result.columns.push_back(faded(i, velocity));
        }
    }
    result.at_value = [faded](const EffectShape& shape, double value) {
        return faded(shape.columns.front(), value);
    };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        return std::vector{stribeck_coulomb.at(coefficients[0]),
                           stribeck_static.at(coefficients[0] + coefficients[1]),
                           stribeck_velocity.at(shape.value)};
    };
    return {std::move(result)};
}

EffectDisposition extend_by_stribeck(ModelExtension& extension, const ChosenEffect& chosen) {
    EffectModel faded = on_joint(chosen, effect_kinds::stribeck_friction);
    faded.stribeck_velocity = chosen.shape.value;
    add_column(extension, chosen, faded, 1);
    return add_single(extension, chosen, effect_kinds::coulomb_friction);
}

} // namespace

Effect effects::stribeck_friction() {
    return {.name = "stribeck_friction",
            .where = "jointK",
            .parameters = {stribeck_coulomb, stribeck_static, stribeck_velocity},
            .evidence = "changes sign with the direction of motion and is largest at the lowest speeds",
            .experiment = "move this joint alone at constant speeds from very slow to medium: the torque "
                          "first falls with speed",
            .in_extended_model = "adapting; the velocity is constant",
            .friction = true,
            .each = Each::torque_joint,
            .candidates = stribeck_candidates,
            .plotted_over = over_velocity,
            .extend = extend_by_stribeck};
}

} // namespace dfdyn::tools
