// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/model/model.hpp"

#include <Eigen/Core>

#include <memory>

namespace dfdyn::tools {

/// xi_(i,j) = gain_j * (row_j' q_i(t^-)) / (its standard deviation for joint i). The length of a row has no
/// influence.
struct InputRows {
    Eigen::MatrixXd rows; ///< k x (M+1)
    Eigen::VectorXd gain; ///< k relevance gains > 0; gain_0 = 1, since the length scale has the same effect
};

/// Gradient of a scalar with respect to InputRows.
struct InputRowsGradient {
    Eigen::MatrixXd rows;
    Eigen::VectorXd gain;
};

/// Bounds of the parameters for the optimiser.
struct Bounds {
    Eigen::VectorXd lower;
    Eigen::VectorXd upper;
};

/// Returns the bounds of `count` relevance gains that are learned as logarithms: from negligible (1e-3) to
/// dominant (1e3).
Bounds log_gain_bounds(Eigen::Index count);

/// Returns `base` for the first `fixed` starts, and `base` plus normal noise of standard deviation 0.5 for
/// later ones.
Eigen::VectorXd perturbed(const Eigen::VectorXd& base, int index, int fixed, NormalSource& random);

/// Parametrization of the rows of R by a few free parameters (paper, Section V). One class per input kind.
class RowFamily {
  public:
    RowFamily() = default;
    RowFamily(const RowFamily&) = delete;
    RowFamily& operator=(const RowFamily&) = delete;
    virtual ~RowFamily() = default;

    virtual Bounds bounds() const = 0; ///< one entry per parameter
    virtual InputRows evaluate(const Eigen::VectorXd& parameters) const = 0;

    /// Chain rule from the rows to the parameters.
    virtual Eigen::VectorXd pull_back(const Eigen::VectorXd& parameters,
                                      const InputRowsGradient& gradient) const = 0;

    /// Returns the initial parameters of start number `index` = 0, 1, …; the first ones are fixed, further
    /// ones perturbed.
    virtual Eigen::VectorXd start(int index, NormalSource& random) const = 0;

    /// Returns the factors of the gains that the stored matrix R includes: R = diag(factor) rows, scale =
    /// gain / (factor s).
    virtual Eigen::VectorXd stored_gain(const InputRows& rows) const = 0;

    /// Sets the fields of this family only (DFSR: alpha and beta).
    virtual void describe(const Eigen::VectorXd& /*parameters*/, InputModel& /*model*/) const {}
};

/// DF: R = I, nothing to learn.
std::unique_ptr<RowFamily> identity_rows(int lags);

/// DFW: R = diag(1, r_1 … r_M), r_j > 0 (a sign would not change the kernel), learned as log r_j. The stored
/// R is this diagonal.
std::unique_ptr<RowFamily> diagonal_rows(int lags);

/// DFR: R_0 = newest position; the other k-1 rows are free, with length 1. They are learned in the
/// coordinates theta_j = T r_j of `pooled_factor` (see LagSpread); the length of theta_j is the gain. 1 <= k
/// <= lags + 1.
std::unique_ptr<RowFamily> free_rows(int lags, int count, const Eigen::MatrixXd& pooled_factor);

/// Returns the parameters of free_rows() with the same `pooled_factor` that result in `rows` and their gains
/// (up to the rows' lengths). Rows beyond those of `rows` have the parameters `others`.
Eigen::VectorXd free_parameters(const InputRows& rows, const Eigen::MatrixXd& pooled_factor,
                                Eigen::VectorXd others);

/// DFSR: the position, velocity and acceleration rows of Section V-C of the paper, truncated after lag M.
/// Learned: log alpha_1, log alpha_2, logit beta_1, logit beta_2. The stored R is that of the paper with
/// these alphas. Its scale is 1 / standard deviation of the row with alpha = 1. Therefore alpha is the
/// relevance of the input with unit standard deviation, instead of 1/T_s and 1/T_s^2, and the sample period
/// is not needed. 2 <= lags.
std::unique_ptr<RowFamily> structured_rows(int lags);

} // namespace dfdyn::tools
