// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/data/training_data.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tests {

/// The regression of a model as the paper defines it, in double precision. Output k at row t is x_(k,t)' [w_1
/// … w_m, pi] + mean_(k,t) in units of its noise for every structure: NP has no pi, P has no w, and SP and
/// SP2 have their pi in the mean.
class DenseRegression {
  public:
    /// Computes the columns of `model` at all rows of `data`, with the derivatives that the model would use.
    DenseRegression(const tools::TrainedModel& model, const tools::TrainingData& data);

    /// The vector x of output `k` at `row`.
    [[nodiscard]] Eigen::VectorXd unknowns_row(Eigen::Index row, Eigen::Index k) const;
    [[nodiscard]] double mean(Eigen::Index row, Eigen::Index k) const { return means_(row, k); }
    [[nodiscard]] double target(Eigen::Index row, Eigen::Index k) const { return targets_(row, k); }
    [[nodiscard]] Eigen::Index outputs() const { return targets_.cols(); }
    [[nodiscard]] Eigen::Index unknowns() const { return outputs() * features_.cols() + parameters_; }

    /// Prior standard deviation of each unknown.
    [[nodiscard]] Eigen::VectorXd prior_deviation() const;

    /// Prediction of the same regression by the model's own start, in units of the noise.
    [[nodiscard]] double predicted_by_start(const tools::TrainedModel& model, Eigen::Index row,
                                            Eigen::Index k) const;

  private:
    [[nodiscard]] Eigen::VectorXd start_of(const tools::TrainedModel& model) const;

    Eigen::MatrixXd features_; ///< rows × 2d
    Eigen::MatrixXd physics_;  ///< rows × m p, in units of the noise; empty unless pi is learned
    Eigen::MatrixXd means_;    ///< rows × m
    Eigen::MatrixXd targets_;  ///< rows × m
    Eigen::Index parameters_ = 0;
    double weight_variance_ = 0;
    double parameter_variance_ = 0;
};

/// Regularised least-squares solution over some rows for all unknowns at once, by Householder QR.
class DenseSolution {
  public:
    DenseSolution(const DenseRegression& regression, const tools::RowList& rows);

    [[nodiscard]] double prediction(Eigen::Index row, Eigen::Index k) const;
    /// Standard deviation of the measurement about the prediction.
    [[nodiscard]] double standard_deviation(Eigen::Index row, Eigen::Index k) const;

  private:
    const DenseRegression* regression_;
    Eigen::VectorXd solution_;
    Eigen::MatrixXd root_; ///< upper triangular, root' root = the information
};

} // namespace dfdyn::tests
