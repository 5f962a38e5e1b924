// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/sliding.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

Effect effects::rotor_inertia() {
    static constexpr ParameterKind inertia{"inertia", "kg·m²"};
    return {.name = "rotor_inertia",
            .where = "jointK",
            .parameters = {inertia},
            .evidence = "is in proportion to the joint's own acceleration, whatever the posture",
            .experiment = "swing this joint alone with growing frequency in two postures: the extra inertia "
                          "is the same in both",
            .in_extended_model = "adapting",
            .textbook = TextbookTerm::inertia,
            .each = Each::torque_joint,
            .candidates =
                [](const DiagnosisSignals& signals, std::size_t number) {
                    const JointSignals joint(signals, number);
                    return std::vector{single_column(
                        joint.where, joint.column(signals.measured.motion.acceleration.col(joint.output)),
                        is_positive, inertia)};
                },
            .plotted_over =
                [](const PlottedFinding& at) {
                    return at.whole(at.named("acceleration", "rad/s²"),
                                    at.signals.measured.motion.acceleration.col(at.joint()));
                },
            .extend =
                [](ModelExtension& extension, const ChosenEffect& chosen) {
                    return add_single(extension, chosen, effect_kinds::rotor_inertia);
                }};
}

} // namespace dfdyn::tools
