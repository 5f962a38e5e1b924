// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/regressor.hpp"

#include "dfdyn/physics/rigid_body.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <vector>

namespace dfdyn::tools {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class Arm>
RowMajor regressor(const Robot& robot, const RobotMotion& motion) {
    const auto chain = firmware_chain<Arm, double>(robot);
    const auto sizes = firmware_sizes<Arm>(robot);
    const int outputs = sizes.output_count;
    const int columns = inertial_parameters * sizes.body_count;
    RowMajor psi(outputs * motion.rows(), columns);
    std::vector<double> xi(3 * robot.joints.size());
    for (Eigen::Index row = 0; row < motion.rows(); ++row) {
        for (std::size_t i = 0; i < robot.joints.size(); ++i) {
            const auto joint = static_cast<Eigen::Index>(i);
            xi[3 * i] = motion.position(row, joint);
            xi[3 * i + 1] = motion.velocity(row, joint);
            xi[3 * i + 2] = motion.acceleration(row, joint);
        }
        rigid_body_regressor<Arm, double>(chain, sizes, xi.data(), psi.row(row * outputs).data(), columns);
    }
    return psi;
}

} // namespace

Eigen::MatrixXd stacked_regressor(const Robot& robot, OutputKind outputs, const RobotMotion& motion) {
    return outputs == OutputKind::wrench ? regressor<Chain<dynamic, WrenchAtSensor<dynamic>>>(robot, motion)
                                         : regressor<Chain<dynamic>>(robot, motion);
}

Eigen::MatrixXd unstacked(const Eigen::VectorXd& stacked, Eigen::Index outputs) {
    return Eigen::Map<const RowMajor>(stacked.data(), stacked.size() / outputs, outputs);
}

Eigen::VectorXd stacked(const Eigen::MatrixXd& outputs) { return outputs.reshaped<Eigen::RowMajor>(); }

} // namespace dfdyn::tools
