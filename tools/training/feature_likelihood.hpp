// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/input_map.hpp"
#include "tools/training/minimise.hpp"

#include <Eigen/Core>

#include <optional>

namespace dfdyn::tools {

/// -2 log marginal likelihood of the model that will run: the random features of one draw of omega in place
/// of the exact kernel, C = Phi Phi' + r I. Its cost is linear in the samples, so that it can take all of
/// them, and it knows how far so few features can follow the kernel. Parameters: [log r, log l, input's own],
/// as of MarginalLikelihood. Refers to `input`.
class FeatureLikelihood {
  public:
    /// `outputs` N x m, means removed; `omega` d x (n k), before division by the length scale.
    FeatureLikelihood(const InputMap& input, Eigen::MatrixXd outputs, Eigen::MatrixXd omega);

    struct Value {
        PointValue point;                ///< -2 log L and its analytic gradient
        Eigen::VectorXd output_variance; ///< m: rho_k^2, profiled as in ProfiledVarianceLikelihood
    };

    /// Nothing where a number is not finite. O(N (2d)^2 + (2d)^3).
    std::optional<Value> evaluate(const Eigen::VectorXd& theta) const;

  private:
    const InputMap& input_;
    Eigen::MatrixXd outputs_;
    Eigen::MatrixXd omega_;
};

} // namespace dfdyn::tools
