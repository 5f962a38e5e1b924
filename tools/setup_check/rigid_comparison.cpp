// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/rigid_comparison.hpp"

#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/regressor.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index most_rows = 2000;

std::vector<Index> spread_rows(Index rows) {
    std::vector<Index> picked;
    const Index count = std::min(rows, most_rows);
    for (Index i = 0; i < count; ++i) {
        picked.push_back((2 * i + 1) * rows / (2 * count));
    }
    return picked;
}

double unexplained(const MatrixXd& columns, const VectorXd& output) {
    const VectorXd fit = columns.colPivHouseholderQr().solve(output);
    return (output - columns * fit).squaredNorm();
}

} // namespace

MatrixXd nominal_outputs(const Robot& robot, OutputKind kind, const RobotMotion& motion) {
    const VectorXd outputs = stacked_regressor(robot, kind, motion) * nominal_parameters(robot, kind);
    return unstacked(outputs, outputs.size() / motion.rows());
}

RigidComparison::RigidComparison(const Robot& compared, OutputKind output_kind,
                                 std::vector<std::string> names, const RobotMotion& whole,
                                 const MatrixXd& outputs, const VectorXd& sign_velocity)
    : robot(compared), kind(output_kind), output_names(std::move(names)) {
    const std::vector<Index> rows = spread_rows(whole.rows());
    motion = {whole.position(rows, Eigen::all), whole.velocity(rows, Eigen::all),
              whole.acceleration(rows, Eigen::all)};
    measured = outputs(rows, Eigen::all);
    nominal = nominal_outputs(robot, kind, motion);
    direction = (motion.velocity * sign_velocity.cwiseInverse().asDiagonal()).array().tanh();
}

OutputFit fit_output(const RigidComparison& comparison, Index output, Index other, bool spring) {
    const bool friction = !comparison.wrench();
    const RobotMotion& motion = comparison.motion;
    MatrixXd columns(comparison.measured.rows(), 2 + (friction ? 2 : 0) + (friction && spring ? 1 : 0));
    columns.col(0) = comparison.nominal.col(other);
    columns.col(1).setOnes();
    if (friction) {
        columns.col(2) = motion.velocity.col(other);
        columns.col(3) = comparison.direction.col(other);
    }
    if (friction && spring) {
        columns.col(4) = motion.position.col(other);
    }
    const VectorXd centred = comparison.measured.col(output).array() - comparison.measured.col(output).mean();
    const double variance = centred.squaredNorm();
    if (!(variance > 0)) {
        return {};
    }
    const VectorXd fit = columns.colPivHouseholderQr().solve(centred);
    const double left = (centred - columns * fit).squaredNorm();
    const double without = unexplained(columns.rightCols(columns.cols() - 1), centred);
    OutputFit result{fit[0], without > 0 ? 1 - left / without : 0, 0, left / variance};
    if (friction) {
        result.friction_power =
            (columns.middleCols(2, 2) * fit.segment(2, 2)).dot(motion.velocity.col(other)) /
            static_cast<double>(columns.rows());
    }
    return result;
}

} // namespace dfdyn::tools
