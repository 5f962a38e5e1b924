// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Prior of pi (paper, Section III-D).
enum class PhysicsPrior {
    none,     ///< a hyperparameter: generalised least squares
    shared,   ///< N(0, gamma^2 I), gamma^2 from the likelihood
    diagonal, ///< N(0, D), D diagonal from the likelihood
};

/// Sufficient statistics of the likelihood of y_k = Psi_k pi + e_k, e_k ~ N(0, v_k C), for a fixed C.
struct LinearStatistics {
    Eigen::Index samples = 0;             ///< N
    std::vector<Eigen::MatrixXd> squares; ///< m times Psi_k' C^-1 Psi_k, p x p
    Eigen::MatrixXd products;             ///< p x m: Psi_k' C^-1 y_k
    Eigen::VectorXd output_squares;       ///< m: y_k' C^-1 y_k
};

inline Eigen::Index outputs_of(const LinearStatistics& statistics) { return statistics.products.cols(); }
inline Eigen::Index columns_of(const LinearStatistics& statistics) { return statistics.products.rows(); }

/// Number of different gamma^2: 0, 1 or p.
Eigen::Index prior_groups(const LinearStatistics& statistics, PhysicsPrior prior);

/// gamma^2 of each column, from the end of x (see VarianceCriterion); empty without a prior.
Eigen::VectorXd spread_prior(const LinearStatistics& statistics, PhysicsPrior prior,
                             const Eigen::VectorXd& x);

/// -2 log likelihood without m log det C, as a function of x = [log v_1 … log v_m, log gamma^2 …] (one
/// gamma^2 if shared, p if diagonal, none if pi has no prior). pi is integrated out, or has its optimal value
/// if it has no prior.
struct VarianceCriterion {
    double value = 0;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;
    Eigen::VectorXd parameters;      ///< pi
    Eigen::MatrixXd covariance_root; ///< p x p: W with W W' = (Psi' R^-1 Psi + prior precision)^-1
};

/// Returns nothing if the information matrix of pi is not positive definite. O(m p^3).
std::optional<VarianceCriterion> variance_criterion(const LinearStatistics& statistics, PhysicsPrior prior,
                                                    const Eigen::VectorXd& x);

} // namespace dfdyn::tools
