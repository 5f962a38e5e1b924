// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/candidates/true_position.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr ParameterKind eccentric_amplitude{"amplitude", "rad"};
constexpr ParameterKind eccentric_phase{"phase", "rad"};

/// Linearized about an amplitude of sine and cosine. With these amplitudes as coefficients, the sum of the
/// columns is exact.
Candidate eccentric_candidate(const DiagnosisSignals& signals, std::size_t joint, double sine,
                              double cosine) {
    const Eigen::ArrayXd measured = signals.measured.motion.position.col(static_cast<Eigen::Index>(joint));
    const double along_sine = at_least_small(sine);
    const double along_cosine = at_least_small(cosine);
    // measured = true + sine sin(true) + cosine cos(true)
    Eigen::ArrayXd position = measured;
    for (int repetition = 0; repetition < 6; ++repetition) {
        position = measured - along_sine * position.sin() - along_cosine * position.cos();
    }
    const Eigen::MatrixXd first =
        outputs_with_position(signals, joint, -along_sine * position.sin().matrix());
    const Eigen::MatrixXd both = outputs_with_position(signals, joint, (position - measured).matrix());
    Candidate result;
    result.where = place_text(PlaceKind::encoder, joint);
    result.columns = {on_outputs((first - signals.nominal) / along_sine),
                      on_outputs((both - first) / along_cosine)};
    result.shapes = {whole_shape(result, up_to(0.3))};
    result.relinearized_at = [&signals, joint](const EffectShape&, const Eigen::VectorXd& coefficients) {
        return eccentric_candidate(signals, joint, coefficients[0], coefficients[1]);
    };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector{eccentric_amplitude.at(coefficients.norm()),
                           eccentric_phase.at(std::atan2(coefficients[1], coefficients[0]))};
    };
    return result;
}

} // namespace

Effect effects::encoder_eccentricity() {
    return {.name = "encoder_eccentricity",
            .where = "encoderK",
            .parameters = {eccentric_amplitude, eccentric_phase},
            .evidence = "is that of a position error with one cycle per turn",
            .experiment = "compare this encoder with an outside reference over a full turn",
            .in_extended_model = "left out",
            .each = Each::joint,
            .candidates =
                [](const DiagnosisSignals& signals, std::size_t number) {
                    return signals.robot.joints[number].prismatic // a slide has no turns
                               ? std::vector<Candidate>{}
                               : std::vector{eccentric_candidate(signals, number, 0, 0)};
                },
            .plotted_over = over_angle};
}

} // namespace dfdyn::tools
