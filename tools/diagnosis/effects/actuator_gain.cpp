// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

namespace {

constexpr ParameterKind true_over_assumed{"gain", "1", 1};

/// Returns no candidate for a wrench, while gains are not doubted, or for motor currents with unknown torque
/// constants: their unit is unknown, so a gain error cannot be distinguished.
std::vector<Candidate> actuator_gain_candidates(const DiagnosisSignals& signals, const FittedModel& model,
                                                std::size_t number) {
    if (signals.wrench() || !model.gains_may_err) {
        return {};
    }
    const auto output = static_cast<Eigen::Index>(number);
    Candidate result = single_column(place_text(PlaceKind::actuator, number),
                                     on_output(output, model.output.col(output)), up_to(0.8));
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector{true_over_assumed.at(1 / (1 + coefficients[0]))};
    };
    return {std::move(result)};
}

} // namespace

Effect effects::actuator_gain() {
    return {.name = "actuator_gain",
            .where = "actuatorK",
            .parameters = {true_over_assumed},
            .remark = ": true over assumed torque constant",
            .evidence = "is in proportion to the joint's whole torque",
            .experiment = "hold a known weight at a known distance and compare the torque with the product",
            .in_extended_model = "constant",
            .beyond_arm = true,
            .each = Each::reading,
            .fitted_candidates = actuator_gain_candidates,
            .plotted_over = over_output,
            .extend = add_gain};
}

} // namespace dfdyn::tools
