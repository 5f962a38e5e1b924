// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

// Eigen's decompositions of dense matrices, each of which takes seconds to compile: here they are compiled
// once. Matrices may be of any size; none is checked for NaN.

/// R of rows = Q R, min(n, p) x p, upper triangular. `rows` is n x p. By Householder reflections, O(n p^2).
Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& rows);

struct OrthogonalFactors {
    Eigen::MatrixXd q; ///< n x min(n, p), orthonormal columns
    Eigen::MatrixXd r; ///< min(n, p) x p, upper triangular; the signs of its diagonal are not fixed
};

/// matrix = Q R by Householder reflections, O(n p^2).
OrthogonalFactors orthogonal_factors(const Eigen::MatrixXd& matrix);

struct PivotedFactor {
    Eigen::MatrixXd r;     ///< min(n, p) x p, upper triangular, with a diagonal that does not grow
    Eigen::VectorXi order; ///< which column stands at each place of R
};

/// R of the columns in the order in which each adds most to those before it. O(n p^2).
PivotedFactor pivoted_factor(const Eigen::MatrixXd& columns);

/// X that makes |columns X - right| least, p x outputs; 0 for what depends on other columns within rounding.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& right);
Eigen::VectorXd least_squares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& right);

/// X of square X = right, for a symmetric matrix that is positive semidefinite. Only the lower triangle is
/// read. By L D L', O(n^3).
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& square, const Eigen::MatrixXd& right);
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& square, const Eigen::VectorXd& right);

/// Of a square matrix of full rank, by L U with partial pivoting; has Inf or NaN where the rank is less.
Eigen::MatrixXd inverse_matrix(const Eigen::MatrixXd& square);

/// Moore and Penrose's, p x n.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& matrix);

struct SingularValues {
    Eigen::MatrixXd u;      ///< n x min(n, p)
    Eigen::VectorXd values; ///< descending
    Eigen::MatrixXd v;      ///< p x min(n, p)
};

/// matrix = U diag(values) V'.
SingularValues singular_values(const Eigen::MatrixXd& matrix);

} // namespace dfdyn::tools
