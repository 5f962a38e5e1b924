// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/wrench_axes.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"

namespace dfdyn::tools {

namespace {

constexpr ParameterKind crosstalk_gain{"gain", "to_axis/from_axis"}; // the unit is that of the two axes
constexpr ParameterKind crosstalk_from{"from_axis", ""};
constexpr ParameterKind crosstalk_to{"to_axis", ""};

std::vector<Candidate> crosstalk_candidates(const DiagnosisSignals&, const FittedModel& model,
                                            std::size_t number) {
    const AxisPair pair(number);
    if (pair.own()) {
        return {};
    }
    Candidate result = pair.candidate(model);
    const std::string unit = std::string(wrench_units[static_cast<std::size_t>(pair.to)]) + "/" +
                             wrench_units[static_cast<std::size_t>(pair.from)];
    result.parameters = [pair, unit](const Eigen::VectorXd& coefficients, const EffectShape&) {
        EffectParameter gain = crosstalk_gain.at(coefficients[0]);
        gain.unit = unit;
        return std::vector{gain, crosstalk_from.at(static_cast<double>(pair.from)),
                           crosstalk_to.at(static_cast<double>(pair.to))};
    };
    return {std::move(result)};
}

} // namespace

Effect effects::ft_crosstalk() {
    return {.name = "ft_crosstalk",
            .where = "ft_sensor",
            .parameters = {crosstalk_gain, crosstalk_from, crosstalk_to},
            .evidence = "is in proportion to another axis of the wrench",
            .experiment = "hang a known weight along the other axis and watch this one",
            .in_extended_model = "left out",
            .beyond_arm = true,
            .each = Each::axis_pair,
            .fitted_candidates = crosstalk_candidates};
}

} // namespace dfdyn::tools
