// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/textbook.hpp"

#include "tools/base/numerics/linear_algebra.hpp"

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Least squares of columns that may be zero or combinations of each other.
VectorXd damped_least_squares(const MatrixXd& columns, const VectorXd& right) {
    constexpr double damping = 1e-8; // of the squared norm of each column
    const VectorXd norm = columns.colwise().norm();
    const VectorXd scale = (norm.array() > 0).select(norm.cwiseInverse(), 0);
    const MatrixXd scaled = columns * scale.asDiagonal();
    const Index count = columns.cols();
    return scale.asDiagonal() *
           solve_symmetric(MatrixXd(scaled.transpose() * scaled + damping * MatrixXd::Identity(count, count)),
                           VectorXd(scaled.transpose() * right));
}

} // namespace

MatrixXd textbook_columns(const DiagnosisSignals& signals, const VectorXd& rigid, Index output) {
    const RobotMotion& motion = signals.measured.motion;
    MatrixXd columns = MatrixXd::Zero(rigid.size(), 5);
    columns.col(0) = rigid;
    if (!signals.wrench()) {
        columns.col(1) = motion.acceleration.col(output);
        columns.col(2) = motion.velocity.col(output);
        columns.col(3) = signals.direction(output);
    }
    columns.col(4).setOnes();
    return columns;
}

TextbookFit textbook_fit(const DiagnosisSignals& signals, const MatrixXd& measured, const MatrixXd& rigid,
                         Index rows) {
    TextbookFit fit{MatrixXd::Zero(5, measured.cols()), MatrixXd(measured.rows(), measured.cols())};
    for (Index output = 0; output < measured.cols(); ++output) {
        const MatrixXd columns = textbook_columns(signals, rigid.col(output), output);
        fit.coefficients.col(output) =
            damped_least_squares(columns.topRows(rows), measured.col(output).head(rows));
        fit.prediction.col(output) = columns * fit.coefficients.col(output);
    }
    return fit;
}

} // namespace dfdyn::tools
