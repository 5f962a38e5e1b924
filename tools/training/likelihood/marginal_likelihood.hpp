// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/input_map.hpp"
#include "tools/training/likelihood/likelihood.hpp"

#include <Eigen/Core>

#include <optional>

namespace dfdyn::tools {

/// The hyperparameters as the optimiser's vector: [log r, log l, input's own, physics' own], with the noise
/// ratio r = sigma^2 / rho^2 and the length scale l. Variances of outputs and of pi are not included: they
/// have their optimal values for every theta.
struct Hyperparameters {
    double noise_ratio = 0;
    double length_scale = 0;
    Eigen::VectorXd input;
    Eigen::VectorXd physics;
};

/// Number of the kernel's parameters: the logarithms of r and l, which come first.
constexpr Eigen::Index kernel_parameters = 2;

Eigen::VectorXd joined(double log_noise_ratio, double log_length_scale, const Eigen::VectorXd& rest);

/// -2 log marginal likelihood of the training samples with the exact Gaussian kernel (paper, Section IV-C),
/// with its analytic gradient. Refers to both parts, which must outlive it.
class MarginalLikelihood final : public Likelihood {
  public:
    MarginalLikelihood(const InputMap& input, const OutputLikelihood& outputs)
        : input_(input), outputs_(outputs) {}

    /// O(N^3 + N^2 n k), and O(N^2 m p) with p columns of physics.
    std::optional<LikelihoodValue> evaluate(const Eigen::VectorXd& theta) const override;

    Hyperparameters split(const Eigen::VectorXd& theta) const;

    /// Returns the bounds: r in [1e-6, 100], because float32 learners lose accuracy below; l in [0.01, 1000]
    /// for inputs with unit standard deviation.
    Bounds bounds() const;

    /// Returns the initial point of start number `index`.
    Eigen::VectorXd start(int index, NormalSource& random) const;

  private:
    const InputMap& input_;
    const OutputLikelihood& outputs_;
};

} // namespace dfdyn::tools
