// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/input_map.hpp"
#include "tools/training/output_likelihood.hpp"

#include <Eigen/Core>

#include <optional>

namespace dfdyn::tools {

/// The hyperparameters as the optimiser's vector: [log r, log l, input's own, likelihood's own],
/// r = sigma^2 / rho^2 the noise ratio, l the length scale.
struct Hyperparameters {
    double noise_ratio = 0;
    double length_scale = 0;
    Eigen::VectorXd input;
    Eigen::VectorXd likelihood;
};

/// -2 log marginal likelihood of the training samples under the exact Gaussian kernel (section
/// "Hyperparameter vector estimation"), with its analytic gradient. Refers to both parts, which must outlive
/// it.
class MarginalLikelihood {
  public:
    MarginalLikelihood(const InputMap& input, const OutputLikelihood& outputs)
        : input_(input), outputs_(outputs) {}

    struct Value {
        double minus_two_log_likelihood = 0;
        Eigen::VectorXd gradient;        ///< one entry per element of theta
        Eigen::VectorXd output_variance; ///< m: rho_k^2
    };

    /// Nothing where the covariance cannot be factored or a number is not finite. O(N^3 + N^2 n k).
    std::optional<Value> evaluate(const Eigen::VectorXd& theta) const;

    Hyperparameters split(const Eigen::VectorXd& theta) const;

    /// r in [1e-6, 100]: below, float32 learners lose their digits; l in [0.01, 1000] of inputs with unit
    /// deviation.
    Bounds bounds() const;

    /// Where start number `index` begins.
    Eigen::VectorXd start(int index, NormalSource& random) const;

  private:
    const InputMap& input_;
    const OutputLikelihood& outputs_;
};

} // namespace dfdyn::tools
