// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/candidates/true_position.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"

#include <Eigen/Geometry>

namespace dfdyn::tools {

namespace {

constexpr ParameterKind offset_angle{"offset", "rad"};

/// Linearized about an offset. With this offset as coefficient, the column is exact.
Candidate offset_candidate(const DiagnosisSignals& signals, std::size_t joint, double angle) {
    const double reference = at_least_small(angle);
    const Eigen::VectorXd everywhere = Eigen::VectorXd::Constant(signals.rows(), reference);
    Candidate result = single_column(
        place_text(PlaceKind::encoder, joint),
        on_outputs((outputs_with_position(signals, joint, -everywhere) - signals.nominal) / reference),
        up_to(0.6), offset_angle);
    result.relinearized_at = [&signals, joint](const EffectShape&, const Eigen::VectorXd& coefficients) {
        return offset_candidate(signals, joint, coefficients[0]);
    };
    return result;
}

/// Moves the joint's zero by the offset, so that the model interprets the measured position correctly.
EffectDisposition extend_by_offset(ModelExtension& extension, const ChosenEffect& chosen) {
    RobotJoint& joint = extension.robot.joints[static_cast<std::size_t>(chosen.number())];
    const double offset = chosen.coefficients[0];
    if (joint.prismatic) {
        joint.placement.translate(-offset * joint.axis);
    } else {
        joint.placement.rotate(Eigen::AngleAxisd(-offset, joint.axis));
    }
    return EffectDisposition::fixed;
}

} // namespace

Effect effects::encoder_offset() {
    return {
        .name = "encoder_offset",
        .where = "encoderK",
        .parameters = {offset_angle},
        .evidence = "is that of a position that is off by a constant",
        .experiment = "move this joint to its mechanical mark and read the encoder",
        .in_extended_model = "constant",
        .each = Each::joint,
        .candidates = [](const DiagnosisSignals& signals,
                         std::size_t number) { return std::vector{offset_candidate(signals, number, 0)}; },
        .extend = extend_by_offset};
}

} // namespace dfdyn::tools
