// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/wrench_axes.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

namespace {

constexpr ParameterKind gain_of_axis{"gain", "1", 1};
constexpr ParameterKind axis_of_gain{"axis", ""};

std::vector<Candidate> ft_gain_candidates(const DiagnosisSignals&, const FittedModel& model,
                                          std::size_t number) {
    const AxisPair pair(number);
    if (!pair.own()) {
        return {};
    }
    Candidate result = pair.candidate(model);
    result.parameters = [pair](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector{gain_of_axis.at(1 + coefficients[0]),
                           axis_of_gain.at(static_cast<double>(pair.to))};
    };
    return {std::move(result)};
}

} // namespace

Effect effects::ft_gain() {
    return {.name = "ft_gain",
            .where = "ft_sensor",
            .parameters = {gain_of_axis, axis_of_gain},
            .evidence = "is in proportion to the same axis of the wrench",
            .experiment = "hang a known weight along this axis of the sensor",
            .in_extended_model = "constant",
            .beyond_arm = true,
            .each = Each::axis_pair,
            .fitted_candidates = ft_gain_candidates,
            .plotted_over = over_output,
            .extend = add_gain};
}

} // namespace dfdyn::tools
