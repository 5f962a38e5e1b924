// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"

namespace dfdyn::tools {

namespace {

constexpr ParameterKind friction_rate{"rate", "1/s"};

/// The level of the joint's friction changes with time. Returns no candidate for a joint whose model has no
/// friction.
std::vector<Candidate> drift_candidates(const DiagnosisSignals& signals, const FittedModel& model,
                                        std::size_t number) {
    const auto joint = static_cast<Eigen::Index>(number);
    if (!model.friction.col(joint).any()) {
        return {};
    }
    const Eigen::VectorXd elapsed = signals.measured.time_s.array() - signals.measured.time_s[0];
    return {single_column(place_text(PlaceKind::joint, number),
                          on_output(joint, model.friction.col(joint).cwiseProduct(elapsed)), is_anything,
                          friction_rate)};
}

} // namespace

Effect effects::friction_drift() {
    return {.name = "friction_drift",
            .where = "jointK",
            .parameters = {friction_rate},
            .remark = ": relative change of the friction",
            .evidence = "is the friction's own shape, with a size that changes with time",
            .experiment = "repeat the same motion cold and after half an hour",
            .in_extended_model = "left out; the friction's own columns adapt",
            .each = Each::torque_joint,
            .fitted_candidates = drift_candidates};
}

} // namespace dfdyn::tools
