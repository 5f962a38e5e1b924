// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/sliding.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

namespace dfdyn::tools {

Effect effects::torque_offset() {
    static constexpr ParameterKind offset{"offset", "N·m"};
    return {.name = "torque_offset",
            .where = "jointK",
            .parameters = {offset},
            .evidence = "is constant",
            .experiment = "hold the arm still in postures where this joint carries no load and read the "
                          "torque",
            .in_extended_model = "adapting",
            .textbook = TextbookTerm::offset,
            .each = Each::torque_joint,
            .candidates =
                [](const DiagnosisSignals& signals, std::size_t number) {
                    const JointSignals joint(signals, number);
                    return std::vector{single_column(joint.where,
                                                     joint.column(Eigen::VectorXd::Ones(signals.rows())),
                                                     is_anything, offset)};
                },
            .plotted_over = over_time,
            .extend =
                [](ModelExtension& extension, const ChosenEffect& chosen) {
                    return add_single(extension, chosen, effect_kinds::torque_offset);
                }};
}

} // namespace dfdyn::tools
