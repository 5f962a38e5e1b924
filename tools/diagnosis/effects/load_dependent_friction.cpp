// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/root_mean_square.hpp"
#include "tools/diagnosis/candidates/sliding.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

constexpr ParameterKind friction_per_load{"mu", "1"};

/// The shapes differ by the distance over which the friction builds up at the rms load.
std::vector<Candidate> load_friction_candidates(const DiagnosisSignals& signals, std::size_t number) {
    const JointSignals joint(signals, number);
    const Eigen::VectorXd load = joint.all.joint_torque.col(joint.output).cwiseAbs();
    const double rms_load = std::max(root_mean_square(load), 1e-9);
    const auto column = [load, rms_load, joint](double distance) {
        return joint.column(rms_load * dahl(joint, distance, load / rms_load));
    };
    Candidate result = joint.candidate();
    for (const double distance : {1.0 / 8, 1.0 / 3, 1.0, 3.0, 9.0}) {
        result.shapes.push_back({{result.columns.size()}, positive_up_to(1), distance * shortest_presliding});
        result.columns.push_back(column(distance * shortest_presliding));
    }
    result.at_value = [column](const EffectShape& /*shape*/, double distance) { return column(distance); };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector{friction_per_load.at(coefficients[0])};
    };
    return {std::move(result)};
}

/// Plots over the load, signed by the direction of motion.
PlotAbscissa over_driven_load(const PlottedFinding& at) {
    const Eigen::ArrayXd velocity = at.signals.measured.motion.velocity.col(at.joint());
    const Eigen::ArrayXd load = at.signals.joint_torque.col(at.joint());
    return at.whole(at.named("|torque| with the sign of the velocity", "N·m"),
                    (load.abs() * velocity.sign()).matrix());
}

} // namespace

Effect effects::load_dependent_friction() {
    return {.name = "load_dependent_friction",
            .where = "jointK",
            .parameters = {friction_per_load},
            .evidence = "changes sign with the direction of motion, with a size in proportion to the joint's "
                        "load",
            .experiment = "repeat one slow motion of this joint with and without a known payload: the "
                          "friction grows with the load",
            .in_extended_model = "left out",
            .friction = true,
            .each = Each::torque_joint,
            .candidates = load_friction_candidates,
            .plotted_over = over_driven_load};
}

} // namespace dfdyn::tools
