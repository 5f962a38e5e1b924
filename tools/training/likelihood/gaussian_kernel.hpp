// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// K_G(x, x') = exp(-|x - x'|^2 / (2 l^2)) between all rows of `inputs` (N x D); the diagonal is exactly 1.
/// O(N^2 D). The inputs' columns should have no large mean: the distances come from inner products.
Eigen::MatrixXd gaussian_kernel(const Eigen::MatrixXd& inputs, double length_scale);

/// Gradient with respect to what the kernel was made from.
struct KernelGradient {
    Eigen::MatrixXd inputs;      ///< N x D
    double log_length_scale = 0; ///< with respect to log l
};

/// Chain rule through gaussian_kernel(): `kernel_gradient` (symmetric) is the derivative with respect to each
/// of the N x N entries as if they were independent; `kernel` is what gaussian_kernel(inputs, length_scale)
/// returned. O(N^2 D).
KernelGradient gaussian_kernel_pull_back(const Eigen::MatrixXd& inputs, double length_scale,
                                         const Eigen::MatrixXd& kernel,
                                         const Eigen::MatrixXd& kernel_gradient);

} // namespace dfdyn::tools
