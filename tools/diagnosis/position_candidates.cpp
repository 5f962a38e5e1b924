// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidate_parts.hpp"
#include "tools/diagnosis/candidates.hpp"
#include "tools/diagnosis/low_pass_kernel.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

Candidate eccentricity(const DiagnosisSignals& signals, std::size_t joint) {
    const Eigen::ArrayXd position = signals.measured.motion.position.col(static_cast<Eigen::Index>(joint));
    Candidate result;
    result.effect = "encoder_eccentricity";
    result.where = numbered("encoder", joint);
    // the true position is the measured one less amplitude · sin(q + phase)
    result.columns = {on_outputs(signals.of_position(joint, -position.sin())),
                      on_outputs(signals.of_position(joint, -position.cos()))};
    result.shapes = {whole_shape(result, up_to(0.3))};
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector<EffectParameter>{{"amplitude", "rad", coefficients.norm()},
                                            {"phase", "rad", std::atan2(coefficients[1], coefficients[0])}};
    };
    return result;
}

/// Low-passed at `share` of where the joint's position was: accelerations of it are to be taken.
Eigen::VectorXd smooth(const DiagnosisSignals& signals, std::size_t joint, const Eigen::VectorXd& series,
                       double share) {
    const double cutoff =
        share * signals.measured.smoothing_hz[static_cast<Eigen::Index>(joint)] / signals.measured.rate_hz;
    const Eigen::VectorXd kernel = low_pass_kernel(cutoff, std::llround(std::ceil(2 / cutoff)));
    Eigen::VectorXd result(series.size());
    for (const Stretch& stretch : signals.measured.stretches) {
        result.segment(stretch.first, stretch.count) =
            filtered(series.segment(stretch.first, stretch.count), kernel);
    }
    return result;
}

/// Which flank of the teeth is in touch, from -1 to 1, as the smoothed positions can show it.
Eigen::VectorXd flank(const DiagnosisSignals& signals, std::size_t joint) {
    const Eigen::VectorXd load = signals.joint_torque.col(static_cast<Eigen::Index>(joint));
    const double softness = 0.02 * std::sqrt(load.squaredNorm() / static_cast<double>(load.size())) + 1e-9;
    return smooth(signals, joint, (load.array() / softness).tanh(), 0.6);
}

} // namespace

std::vector<Candidate> position_candidates(const DiagnosisSignals& signals) {
    std::vector<Candidate> result;
    for (std::size_t joint = 0; joint < signals.joints(); ++joint) {
        const std::string where = numbered("joint", joint);
        const auto index = static_cast<Eigen::Index>(joint);
        result.push_back(
            single_column("encoder_offset", numbered("encoder", joint),
                          on_outputs(signals.of_position(joint, -Eigen::VectorXd::Ones(signals.rows()))),
                          up_to(0.6), "offset", "rad"));
        result.push_back(eccentricity(signals, joint));
        result.push_back(single_column("backlash", where,
                                       on_outputs(signals.of_position(joint, -flank(signals, joint) / 2)),
                                       positive_up_to(0.1), "gap", "rad"));
        Candidate flexibility =
            single_column("joint_flexibility", where,
                          on_outputs(signals.of_position(
                              joint, -smooth(signals, joint, signals.joint_torque.col(index), 0.5))),
                          is_positive);
        flexibility.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
            return std::vector<EffectParameter>{{"stiffness", "N·m/rad", 1 / coefficients[0]}};
        };
        result.push_back(std::move(flexibility));
    }
    return result;
}

} // namespace dfdyn::tools
