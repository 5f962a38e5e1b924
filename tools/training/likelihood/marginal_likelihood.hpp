// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/training/data/input_map.hpp"
#include "tools/training/likelihood/likelihood.hpp"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

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

/// Bounds of r; float learners lose accuracy below the least.
constexpr double noise_ratio_least = 1e-6;
constexpr double noise_ratio_most = 1e2;
/// Bounds of l, for inputs with unit standard deviation.
constexpr double length_scale_least = 1e-2;
constexpr double length_scale_most = 1e3;

/// Returns a sentence with the meaning for each bound that r or l reached.
std::vector<std::string> bounds_reached(double noise_ratio, double length_scale);

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

    Bounds bounds() const;

    /// Returns the initial point of start number `index`.
    Eigen::VectorXd start(int index, NormalSource& random) const;

  private:
    const InputMap& input_;
    const OutputLikelihood& outputs_;
};

} // namespace dfdyn::tools
