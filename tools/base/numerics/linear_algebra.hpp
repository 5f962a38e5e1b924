// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Concatenates two vectors; either may be empty.
inline Eigen::VectorXd concatenated(const Eigen::VectorXd& first, const Eigen::VectorXd& second) {
    Eigen::VectorXd result(first.size() + second.size());
    result << first, second;
    return result;
}

// Eigen's decompositions of dense matrices. Each takes seconds to compile, so they are compiled once, here.
// Matrices of any size are accepted; none is checked for NaN.

/// Returns R of rows = Q R: min(n, p) x p, upper triangular. `rows` is n x p. Householder reflections, O(n
/// p^2).
Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& rows);

struct OrthogonalFactors {
    Eigen::MatrixXd q; ///< n x min(n, p), orthonormal columns
    Eigen::MatrixXd r; ///< min(n, p) x p, upper triangular; the signs of its diagonal are not fixed
};

/// Returns the QR decomposition matrix = Q R by Householder reflections, O(n p^2).
OrthogonalFactors orthogonal_factors(const Eigen::MatrixXd& matrix);

struct PivotedFactor {
    Eigen::MatrixXd r;     ///< min(n, p) x p, upper triangular, with a non-increasing diagonal
    Eigen::VectorXi order; ///< index of the column at each place of R
};

/// Returns R of the QR decomposition with column pivoting: each column is the one with the largest component
/// independent of the previous ones. O(n p^2).
PivotedFactor pivoted_factor(const Eigen::MatrixXd& columns);

/// Returns X that minimizes |columns X - right|, p x outputs; 0 for columns that depend on others within
/// rounding errors.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& right);
Eigen::VectorXd least_squares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& right);

/// Solves square X = right for a symmetric, positive semidefinite matrix. Only the lower triangle is read. L
/// D L' decomposition, O(n^3).
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& square, const Eigen::MatrixXd& right);
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& square, const Eigen::VectorXd& right);

/// Returns the inverse of a square matrix of full rank, by LU decomposition with partial pivoting. For a
/// lower rank the result contains Inf or NaN.
Eigen::MatrixXd inverse_matrix(const Eigen::MatrixXd& square);

/// Returns the Moore–Penrose pseudoinverse, p x n.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& matrix);

struct SingularValues {
    Eigen::MatrixXd u;      ///< n x min(n, p)
    Eigen::VectorXd values; ///< descending
    Eigen::MatrixXd v;      ///< p x min(n, p)
};

/// Returns the singular value decomposition matrix = U diag(values) V'.
SingularValues singular_values(const Eigen::MatrixXd& matrix);

} // namespace dfdyn::tools
