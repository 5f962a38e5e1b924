// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"

namespace dfdyn::tools {

namespace {

constexpr ParameterKind output_delay{"delay", "s"};
constexpr double longest_delay_s = 0.25;

/// Linearized about the delay of the current model: the column is the additional effect per second of delay.
std::vector<Candidate> delay_candidates(const DiagnosisSignals& signals, const FittedModel& model,
                                        std::size_t number) {
    if (signals.wrench()) {
        Eigen::MatrixXd rates(model.output.rows(), 6);
        for (Eigen::Index axis = 0; axis < 6; ++axis) {
            rates.col(axis) = signals.per_delay(model.output.col(axis), model.delay_s[axis]);
        }
        return {single_column("ft_sensor", on_outputs(rates), positive_up_to(longest_delay_s), output_delay)};
    }
    const auto output = static_cast<Eigen::Index>(number);
    return {
        single_column(place_text(PlaceKind::actuator, number),
                      on_output(output, signals.per_delay(model.output.col(output), model.delay_s[output])),
                      positive_up_to(longest_delay_s), output_delay)};
}

} // namespace

Effect effects::delay() {
    return {.name = "delay",
            .where = "ft_sensor, actuatorK",
            .parameters = {output_delay},
            .evidence = "is in proportion to the rate of the output",
            .experiment = "repeat the motion at half the speed: the error halves, the delay stays",
            .in_extended_model = "left out",
            .beyond_arm = true,
            .delays_output = true,
            .each = Each::reading,
            .fitted_candidates = delay_candidates};
}

} // namespace dfdyn::tools
