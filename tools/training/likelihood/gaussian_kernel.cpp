// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/gaussian_kernel.hpp"

namespace dfdyn::tools {

Eigen::MatrixXd gaussian_kernel(const Eigen::MatrixXd& inputs, double length_scale) {
    const Eigen::MatrixXd scaled = inputs / length_scale;
    const Eigen::VectorXd half_squares = 0.5 * scaled.rowwise().squaredNorm();
    Eigen::MatrixXd kernel = scaled * scaled.transpose();
    kernel.colwise() -= half_squares;
    kernel.rowwise() -= half_squares.transpose();
    kernel = kernel.array().min(0.0).exp();
    kernel.diagonal().setOnes();
    return kernel;
}

KernelGradient gaussian_kernel_pull_back(const Eigen::MatrixXd& inputs, double length_scale,
                                         const Eigen::MatrixXd& kernel,
                                         const Eigen::MatrixXd& kernel_gradient) {
    const Eigen::MatrixXd weights = kernel_gradient.cwiseProduct(kernel);
    const Eigen::VectorXd sums = weights.rowwise().sum();
    KernelGradient gradient;
    gradient.inputs = weights * inputs;
    gradient.inputs -= sums.asDiagonal() * inputs;
    gradient.inputs *= 2 / (length_scale * length_scale);
    // the kernel depends on inputs / l only
    gradient.log_length_scale = -gradient.inputs.cwiseProduct(inputs).sum();
    return gradient;
}

} // namespace dfdyn::tools
