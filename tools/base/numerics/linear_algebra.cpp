// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

#include <algorithm>

namespace dfdyn::tools {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd triangular_factor(const MatrixXd& rows) {
    const Eigen::HouseholderQR<MatrixXd> qr(rows);
    return qr.matrixQR().topRows(std::min(rows.rows(), rows.cols())).triangularView<Eigen::Upper>();
}

OrthogonalFactors orthogonal_factors(const MatrixXd& matrix) {
    const Eigen::HouseholderQR<MatrixXd> qr(matrix);
    const Eigen::Index rank = std::min(matrix.rows(), matrix.cols());
    return {qr.householderQ() * MatrixXd::Identity(matrix.rows(), rank),
            qr.matrixQR().topRows(rank).triangularView<Eigen::Upper>()};
}

PivotedFactor pivoted_factor(const MatrixXd& columns) {
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
    const Eigen::Index rank = std::min(columns.rows(), columns.cols());
    return {qr.matrixR().topRows(rank).triangularView<Eigen::Upper>(), qr.colsPermutation().indices()};
}

MatrixXd least_squares(const MatrixXd& columns, const MatrixXd& right) {
    if (columns.cols() == 0) { // Eigen's column pivoting reads the first column
        return MatrixXd(0, right.cols());
    }
    return columns.colPivHouseholderQr().solve(right);
}

VectorXd least_squares(const MatrixXd& columns, const VectorXd& right) {
    if (columns.cols() == 0) { // as above
        return VectorXd(0);
    }
    return columns.colPivHouseholderQr().solve(right);
}

MatrixXd solve_symmetric(const MatrixXd& square, const MatrixXd& right) { return square.ldlt().solve(right); }

VectorXd solve_symmetric(const MatrixXd& square, const VectorXd& right) { return square.ldlt().solve(right); }

MatrixXd inverse_matrix(const MatrixXd& square) { return square.inverse(); }

MatrixXd pseudo_inverse(const MatrixXd& matrix) {
    return matrix.completeOrthogonalDecomposition().pseudoInverse();
}

SingularValues singular_values(const MatrixXd& matrix) {
    const Eigen::JacobiSVD<MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
    return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

} // namespace dfdyn::tools
