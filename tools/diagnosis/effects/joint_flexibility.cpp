// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/candidates/true_position.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

namespace {

constexpr ParameterKind joint_stiffness{"stiffness", "N·m/rad"};

/// Elasticity between encoder and link.
std::vector<Candidate> flexibility_candidates(const DiagnosisSignals& signals, std::size_t number) {
    const auto joint = static_cast<Eigen::Index>(number);
    Candidate result =
        single_column(place_text(PlaceKind::joint, number),
                      on_outputs(signals.of_position(
                          number, -smooth_change(signals, number, signals.joint_torque.col(joint), 0.5))),
                      is_positive);
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector{joint_stiffness.at(1 / coefficients[0])};
    };
    return {std::move(result)};
}

} // namespace

Effect effects::joint_flexibility() {
    return {.name = "joint_flexibility",
            .where = "jointK",
            .parameters = {joint_stiffness},
            .evidence = "looks like a position that yields in proportion to the joint's load",
            .experiment = "hold the motor, hang known weights on the link, and measure how far the link "
                          "gives way",
            .in_extended_model = "left out",
            .each = Each::joint,
            .candidates = flexibility_candidates,
            .plotted_over = over_load};
}

} // namespace dfdyn::tools
