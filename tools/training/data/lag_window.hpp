// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/row_selection.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace dfdyn::tools {

/// Lag windows q_i(t^-) of the given usable rows: rows x n(M+1); column i(M+1)+j is joint i, j samples ago.
Eigen::MatrixXd lag_windows(const Eigen::MatrixXd& positions, const RowList& rows, int lags);

/// Standard deviations of r' q_i(t^-) over a set of rows, for any r. Each joint's windows are stored as the
/// triangular factor T_i of their QR decomposition, T_i' T_i = C_i. The norm |T_i r| is accurate where r' C_i
/// r would suffer from cancellation (second differences).
class LagSpread {
  public:
    /// `rows` must be usable and not empty. O(rows * n * (M+1)^2), memory O(n (M+1)^2).
    LagSpread(const Eigen::MatrixXd& positions, const RowList& rows, int lags);

    /// Returns the standard deviation s = |T_i r|. Returns 0 for a constant input:
    /// - a held joint: its standard deviation is at most a thousandth of the largest joint's. It is also at
    ///   most 5e-4 rad (m), or at most 30 times the joint's own noise (of third differences, or its smallest
    ///   step);
    /// - a combination that differs from 0 by rounding errors only.
    double deviation(Eigen::Index joint, const Eigen::VectorXd& row) const;

    /// ds/dr = T_i' T_i r / s. Only where deviation() > 0.
    Eigen::VectorXd deviation_gradient(Eigen::Index joint, const Eigen::VectorXd& row) const;

    /// Returns an upper triangular, nonsingular T. T' T is the mean over the moving joints of C_i / (variance
    /// of joint i), plus a floor. In the coordinates theta = T r, |theta| is the standard deviation for a
    /// typical joint, which makes rows comparable.
    Eigen::MatrixXd pooled_factor() const;

    /// Returns the held joints, from 0 and ascending.
    std::vector<std::size_t> held_joints() const;

    Eigen::Index joints() const { return static_cast<Eigen::Index>(factors_.size()); }
    int lags() const { return lags_; }

  private:
    int lags_;
    std::vector<Eigen::MatrixXd> factors_;   // T_i, (M+1) x (M+1)
    std::vector<double> position_deviation_; // |first column of T_i|
    std::vector<bool> held_;
};

} // namespace dfdyn::tools
