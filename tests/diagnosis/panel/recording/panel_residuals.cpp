// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/recording/panel_setup.hpp"
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/base/recording/zero_phase_derivatives.hpp"

#include <cmath>

namespace dfdyn::tests {

using namespace tools;

namespace {

const char* const real_recording = "/ur5_kufieta/Movement_No6_Acc_slow_Verify_Model.csv";

Recording read_real() {
    ReadOptions options;
    options.outputs = OutputKind::motor_current;
    return read_recording(std::string(DFDYN_TEST_DATA_DIR) + real_recording, options);
}

Eigen::MatrixXd rows_of(const Columns& columns) {
    const auto width = static_cast<Eigen::Index>(columns.names.size());
    const auto count = static_cast<Eigen::Index>(columns.values.size()) / width;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const Rows>(columns.values.data(), count, width);
}

/// Regressor of a joint's current: rigid-body torques and accelerations of all joints, its own friction at
/// several scales of velocity, and its position.
Eigen::MatrixXd explanation(const Eigen::MatrixXd& torque, const Eigen::MatrixXd& acceleration,
                            const Eigen::VectorXd& position, const Eigen::VectorXd& velocity) {
    Eigen::MatrixXd columns(torque.rows(), torque.cols() + acceleration.cols() + 8);
    const Eigen::ArrayXd v = velocity.array();
    columns << torque, acceleration, Eigen::VectorXd::Ones(torque.rows()), velocity, v.abs().matrix(),
        v.cube().matrix(), (v / 0.02).tanh().matrix(), (v / 0.2).tanh().matrix(),
        position.array().sin().matrix(), position.array().cos().matrix();
    return columns;
}

std::vector<std::vector<double>> residuals() {
    const Recording recording = read_real();
    const SampledDerivatives rates = zero_phase_derivatives(recording, recording.position, {12, 3});
    PanelSetup arm;
    arm.kind = panel_robot("ur5_torque");
    arm.robot = read_panel_robot(arm.kind);
    const MotionRows motion{rows_of(recording.position), rates.first, rates.second};
    // Without the ends, where the windows of the derivatives are incomplete.
    const Eigen::Index inner = motion.position.rows() - 100;
    const Eigen::MatrixXd torque = rigid_outputs(arm, arm.robot, motion).middleRows(50, inner);
    const Eigen::MatrixXd current = rows_of(recording.output).middleRows(50, inner);
    std::vector<std::vector<double>> result;
    for (Eigen::Index joint = 0; joint < current.cols(); ++joint) {
        const Eigen::MatrixXd columns = explanation(torque, motion.acceleration.middleRows(50, inner),
                                                    motion.position.col(joint).segment(50, inner),
                                                    motion.velocity.col(joint).segment(50, inner));
        const Eigen::VectorXd left =
            current.col(joint) - columns * tools::least_squares(columns, Eigen::VectorXd(current.col(joint)));
        result.emplace_back(left.begin(), left.end());
    }
    return result;
}

} // namespace

const std::vector<std::vector<double>>& real_residuals() {
    static const std::vector<std::vector<double>> result = residuals();
    return result;
}

} // namespace dfdyn::tests
