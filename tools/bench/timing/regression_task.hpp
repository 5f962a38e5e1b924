// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstddef>

namespace dfdyn::tools {

/// The common task of all compared learners: rows of random Fourier features of random inputs, and targets
/// that are a smooth function of the inputs, with noise. The rows repeat cyclically.
class RegressionTask {
  public:
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    static constexpr int outputs = 6;
    static constexpr int inputs = 12;
    static constexpr int distinct_rows = 128;
    static constexpr double prior_variance = 100;

    /// `columns`: 2d, even.
    explicit RegressionTask(int columns);

    int columns() const noexcept { return static_cast<int>(rows_.cols()); }
    const Matrix& rows() const noexcept { return rows_; }       ///< distinct rows × columns
    const Matrix& targets() const noexcept { return targets_; } ///< distinct rows × outputs

    /// Solves the regularised least-squares problem of the first `samples` (the rows in turn) at once in
    /// double. Returns the predictions for all distinct rows.
    Matrix batch_predictions(int samples) const;

  private:
    Matrix rows_, targets_;
};

/// Returns the largest difference divided by the rms of the expected values; infinite if a prediction is not
/// finite.
double relative_error(const RegressionTask::Matrix& predictions, const RegressionTask::Matrix& expected);

} // namespace dfdyn::tools
