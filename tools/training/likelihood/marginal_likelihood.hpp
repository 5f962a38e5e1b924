// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/input_map.hpp"
#include "tools/training/likelihood/likelihood.hpp"

#include <Eigen/Core>

#include <optional>

namespace dfdyn::tools {

/// The hyperparameters as the optimiser's vector: [log r, log l, input's own, physics' own], r = sigma^2 /
/// rho^2 the noise ratio, l the length scale. Variances of outputs and of pi are not among them: they have
/// their best values at every theta.
struct Hyperparameters {
    double noise_ratio = 0;
    double length_scale = 0;
    Eigen::VectorXd input;
    Eigen::VectorXd physics;
};

/// The logarithms of r and l come first.
constexpr Eigen::Index kernel_parameters = 2;

Eigen::VectorXd joined(double log_noise_ratio, double log_length_scale, const Eigen::VectorXd& rest);

/// -2 log marginal likelihood of the training samples under the exact Gaussian kernel (section
/// "Hyperparameter vector estimation"), with its analytic gradient. Refers to both parts, which must outlive
/// it.
class MarginalLikelihood final : public Likelihood {
  public:
    MarginalLikelihood(const InputMap& input, const OutputLikelihood& outputs)
        : input_(input), outputs_(outputs) {}

    /// O(N^3 + N^2 n k), and O(N^2 m p) with p columns of physics.
    std::optional<LikelihoodValue> evaluate(const Eigen::VectorXd& theta) const override;

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
