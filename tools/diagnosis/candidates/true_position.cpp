// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/true_position.hpp"

namespace dfdyn::tools {

Eigen::MatrixXd outputs_with_position(const DiagnosisSignals& signals, std::size_t joint,
                                      const Eigen::VectorXd& change) {
    const auto index = static_cast<Eigen::Index>(joint);
    RobotMotion motion = signals.measured.motion;
    const Eigen::VectorXd velocity = signals.rate(change);
    motion.position.col(index) += change;
    motion.velocity.col(index) += velocity;
    motion.acceleration.col(index) += signals.rate(velocity);
    return rigid_outputs(signals.robot, signals.kind, motion);
}

Eigen::VectorXd smooth_change(const DiagnosisSignals& signals, std::size_t joint,
                              const Eigen::VectorXd& change, double share) {
    return signals.below(share * signals.measured.smoothing_hz[static_cast<Eigen::Index>(joint)], change);
}

} // namespace dfdyn::tools
