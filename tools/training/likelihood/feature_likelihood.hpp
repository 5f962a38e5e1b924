// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/input_map.hpp"
#include "tools/training/likelihood/likelihood.hpp"

#include <Eigen/Core>

#include <optional>

namespace dfdyn::tools {

/// Returns the number of samples whose features, d = `frequencies`, and gradients take about 200 MB.
Eigen::Index feature_rows_at_once(Eigen::Index frequencies);

/// -2 log marginal likelihood of the model that the estimator uses: with the random features of one draw of
/// omega instead of the exact kernel, C = Phi Phi' + r I. It includes the approximation error of the
/// features. Its cost is linear in the number of samples, so it can use all of them; the features of many
/// samples are computed in blocks. Parameters as in MarginalLikelihood. Refers to `input` and `outputs`.
class FeatureLikelihood final : public Likelihood {
  public:
    /// `omega` d x (n k), before division by the length scale.
    FeatureLikelihood(const InputMap& input, const OutputLikelihood& outputs, Eigen::MatrixXd omega)
        : FeatureLikelihood(input, outputs, omega, feature_rows_at_once(omega.rows())) {}

    /// `rows_at_once` >= 1: samples of a block.
    FeatureLikelihood(const InputMap& input, const OutputLikelihood& outputs, Eigen::MatrixXd omega,
                      Eigen::Index rows_at_once)
        : input_(input), outputs_(outputs), omega_(std::move(omega)), rows_at_once_(rows_at_once) {}

    /// O(N (2d)^2 + (2d)^3), and O(N 2d m p) with p columns of physics. Memory O((2d)^2) and about 200 MB for
    /// the features, besides O(N) for inputs, outputs and columns.
    std::optional<LikelihoodValue> evaluate(const Eigen::VectorXd& theta) const override;

  private:
    const InputMap& input_;
    const OutputLikelihood& outputs_;
    Eigen::MatrixXd omega_;
    Eigen::Index rows_at_once_;
};

} // namespace dfdyn::tools
