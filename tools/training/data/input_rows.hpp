// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/model/model.hpp"

#include <Eigen/Core>

#include <memory>

namespace dfdyn::tools {

/// xi_(i,j) = gain_j * (row_j' q_i(t^-)) / (its standard deviation for joint i): the length of a row does not
/// matter.
struct InputRows {
    Eigen::MatrixXd rows; ///< k x (M+1)
    Eigen::VectorXd gain; ///< k relevance gains > 0; gain_0 = 1, the length scale stands for it
};

/// Gradient of a scalar with respect to InputRows.
struct InputRowsGradient {
    Eigen::MatrixXd rows;
    Eigen::VectorXd gain;
};

/// Box that the optimiser stays in.
struct Bounds {
    Eigen::VectorXd lower;
    Eigen::VectorXd upper;
};

/// For `count` relevance gains that are learned as logarithms: from ignored (1e-3) to deciding alone (1e3).
Bounds log_gain_bounds(Eigen::Index count);

/// `base` for the first `fixed` starts, beyond them with normal noise of standard deviation 0.5 on every
/// entry.
Eigen::VectorXd perturbed(const Eigen::VectorXd& base, int index, int fixed, NormalSource& random);

/// How a few free parameters make the rows of R (section "Derivative-free Learning"). One class per input
/// kind.
class RowFamily {
  public:
    RowFamily() = default;
    RowFamily(const RowFamily&) = delete;
    RowFamily& operator=(const RowFamily&) = delete;
    virtual ~RowFamily() = default;

    virtual Bounds bounds() const = 0; ///< as many entries as there are parameters
    virtual InputRows evaluate(const Eigen::VectorXd& parameters) const = 0;

    /// Chain rule from the rows to the parameters.
    virtual Eigen::VectorXd pull_back(const Eigen::VectorXd& parameters,
                                      const InputRowsGradient& gradient) const = 0;

    /// The parameters that start number `index` = 0, 1, … begins with; the first ones are fixed, further ones
    /// perturbed.
    virtual Eigen::VectorXd start(int index, NormalSource& random) const = 0;

    /// The factors by which the stored matrix R carries the gains itself: R = diag(factor) rows, scale = gain
    /// / (factor s).
    virtual Eigen::VectorXd stored_gain(const InputRows& rows) const = 0;

    /// Fills what only this family knows (DFSR: alpha and beta).
    virtual void describe(const Eigen::VectorXd& /*parameters*/, InputModel& /*model*/) const {}
};

/// DF: R = I, nothing to learn.
std::unique_ptr<RowFamily> identity_rows(int lags);

/// DFW: R = diag(1, r_1 … r_M), r_j > 0 (a sign would not change the kernel), learned as log r_j. The stored
/// R is this diagonal.
std::unique_ptr<RowFamily> diagonal_rows(int lags);

/// DFR: R_0 = newest position; the other k-1 rows are free, of length 1. Learned in the coordinates theta_j =
/// T r_j of `pooled_factor` (see LagSpread); the length of theta_j is the gain. 1 <= k <= lags + 1.
std::unique_ptr<RowFamily> free_rows(int lags, int count, const Eigen::MatrixXd& pooled_factor);

/// Parameters of free_rows() with the same `pooled_factor` for which it gives `rows` and their gains (up to
/// the rows' lengths, which do not matter), as far as either has rows; `others` for the rows beyond.
Eigen::VectorXd free_parameters(const InputRows& rows, const Eigen::MatrixXd& pooled_factor,
                                Eigen::VectorXd others);

/// DFSR: position, velocity and acceleration row of eq:input_locations_features_vel_acc cut after lag M.
/// Learned: log alpha_1, log alpha_2, logit beta_1, logit beta_2. The stored R is the paper's with these
/// alphas, its scale is 1 / standard deviation of the row with alpha = 1: alpha is the relevance of the input
/// once it has unit standard deviation, not 1/T_s and 1/T_s^2 (those factors are in the standard deviations,
/// so the sample period is not needed). 2 <= lags.
std::unique_ptr<RowFamily> structured_rows(int lags);

} // namespace dfdyn::tools
