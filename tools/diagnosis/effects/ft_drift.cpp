// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/wrench_axes.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

namespace {

constexpr std::array drift_of_axis{ParameterKind{"fx", "N/s"},   ParameterKind{"fy", "N/s"},
                                   ParameterKind{"fz", "N/s"},   ParameterKind{"mx", "N·m/s"},
                                   ParameterKind{"my", "N·m/s"}, ParameterKind{"mz", "N·m/s"}};

} // namespace

Effect effects::ft_drift() {
    return {.name = "ft_drift",
            .where = "ft_sensor",
            .parameters = {drift_of_axis.begin(), drift_of_axis.end()},
            .evidence = "grows with time, whatever the motion",
            .experiment = "hold the arm still for ten minutes and watch the reading",
            .in_extended_model = "left out",
            .beyond_arm = true,
            .each = Each::sensor,
            .fitted_candidates =
                [](const DiagnosisSignals& signals, const FittedModel&, std::size_t) {
                    const Eigen::VectorXd elapsed =
                        signals.measured.time_s.array() - signals.measured.time_s[0];
                    return std::vector{on_each_axis(elapsed, drift_of_axis)};
                },
            .plotted_over = over_time};
}

} // namespace dfdyn::tools
