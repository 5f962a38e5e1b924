// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/wrench_axes.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

namespace {

constexpr std::array bias_of_axis{ParameterKind{"fx", "N"},   ParameterKind{"fy", "N"},
                                  ParameterKind{"fz", "N"},   ParameterKind{"mx", "N·m"},
                                  ParameterKind{"my", "N·m"}, ParameterKind{"mz", "N·m"}};

EffectDisposition extend_by_bias(ModelExtension& extension, const ChosenEffect& chosen) {
    for (Eigen::Index i = 0; i < chosen.coefficients.size(); ++i) {
        EffectModel bias;
        bias.name = effect_kinds::ft_bias.name;
        const std::size_t column = chosen.shape.columns[static_cast<std::size_t>(i)];
        bias.row = static_cast<int>(chosen.candidate.columns[column].parts.front().output);
        add_column(extension, chosen, bias, i);
    }
    return EffectDisposition::adapting;
}

} // namespace

Effect effects::ft_bias() {
    return {.name = "ft_bias",
            .where = "ft_sensor",
            .parameters = {bias_of_axis.begin(), bias_of_axis.end()},
            .evidence = "is constant in the sensor's own frame",
            .experiment = "hold the sensor still in six orientations: the mean of the readings is the bias",
            .in_extended_model = "adapting",
            .beyond_arm = true,
            .each = Each::sensor,
            .fitted_candidates =
                [](const DiagnosisSignals& signals, const FittedModel&, std::size_t) {
                    return std::vector{on_each_axis(Eigen::VectorXd::Ones(signals.rows()), bias_of_axis)};
                },
            .plotted_over = over_time,
            .extend = extend_by_bias};
}

} // namespace dfdyn::tools
