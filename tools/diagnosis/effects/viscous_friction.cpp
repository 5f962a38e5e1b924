// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/sliding.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

Effect effects::viscous_friction() {
    static constexpr ParameterKind viscous{"viscous", "N·m·s/rad"};
    return {.name = "viscous_friction",
            .where = "jointK",
            .parameters = {viscous},
            .evidence = "grows in proportion to the joint's velocity",
            .experiment = "move this joint alone at five constant speeds in both directions: the torque's "
                          "mean rises linearly with speed",
            .in_extended_model = "adapting",
            .friction = true,
            .textbook = TextbookTerm::viscous,
            .each = Each::torque_joint,
            .candidates =
                [](const DiagnosisSignals& signals, std::size_t number) {
                    const JointSignals joint(signals, number);
                    return std::vector{
                        single_column(joint.where, joint.column(joint.velocity), is_positive, viscous)};
                },
            .plotted_over = over_velocity,
            .extend =
                [](ModelExtension& extension, const ChosenEffect& chosen) {
                    return add_single(extension, chosen, effect_kinds::viscous_friction);
                }};
}

} // namespace dfdyn::tools
