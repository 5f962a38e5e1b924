// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Returns K_G(x, x') = exp(-|x - x'|^2 / (2 l^2)) between all rows of `inputs` (N x D); the diagonal is
/// exactly 1. O(N^2 D). The inputs' columns should not have large means, because the distances are computed
/// from inner products.
Eigen::MatrixXd gaussian_kernel(const Eigen::MatrixXd& inputs, double length_scale);

/// Gradient with respect to the arguments of the kernel.
struct KernelGradient {
    Eigen::MatrixXd inputs;      ///< N x D
    double log_length_scale = 0; ///< with respect to log l
};

/// Chain rule for gaussian_kernel(): `kernel_gradient` (symmetric) is the derivative with respect to each of
/// the N x N entries, treated as independent; `kernel` is the result of gaussian_kernel(inputs,
/// length_scale). O(N^2 D).
KernelGradient gaussian_kernel_pull_back(const Eigen::MatrixXd& inputs, double length_scale,
                                         const Eigen::MatrixXd& kernel,
                                         const Eigen::MatrixXd& kernel_gradient);

} // namespace dfdyn::tools
