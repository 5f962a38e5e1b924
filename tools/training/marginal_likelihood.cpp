// SPDX-License-Identifier: Apache-2.0
#include "tools/training/marginal_likelihood.hpp"

#include "tools/training/gaussian_kernel.hpp"

#include <array>
#include <cmath>

namespace dfdyn::tools {
namespace {

constexpr Eigen::Index own = 2; // log r, log l

Eigen::VectorXd joined(double first, double second, const Eigen::VectorXd& third,
                       const Eigen::VectorXd& fourth) {
    Eigen::VectorXd result(own + third.size() + fourth.size());
    result << first, second, third, fourth;
    return result;
}

} // namespace

Hyperparameters MarginalLikelihood::split(const Eigen::VectorXd& theta) const {
    const Eigen::Index inputs = input_.bounds().lower.size();
    return {std::exp(theta[0]), std::exp(theta[1]), theta.segment(own, inputs),
            theta.tail(theta.size() - own - inputs)};
}

std::optional<MarginalLikelihood::Value> MarginalLikelihood::evaluate(const Eigen::VectorXd& theta) const {
    const Hyperparameters parameters = split(theta);
    const Eigen::MatrixXd inputs = input_.inputs(parameters.input);
    const Eigen::MatrixXd kernel = gaussian_kernel(inputs, parameters.length_scale);
    Eigen::MatrixXd covariance = kernel;
    covariance.diagonal().array() += parameters.noise_ratio;
    const std::optional<CovarianceFactor> factor = CovarianceFactor::of(std::move(covariance));
    if (!factor) {
        return std::nullopt;
    }
    const Evidence evidence = outputs_.evaluate(*factor, parameters.likelihood);
    const KernelGradient gradient =
        gaussian_kernel_pull_back(inputs, parameters.length_scale, kernel, evidence.covariance_gradient);
    Value value;
    value.minus_two_log_likelihood = evidence.minus_two_log_likelihood;
    value.gradient =
        joined(parameters.noise_ratio * evidence.covariance_gradient.trace(), gradient.log_length_scale,
               input_.pull_back(parameters.input, gradient.inputs), evidence.parameter_gradient);
    value.output_variance = evidence.output_variance;
    if (!std::isfinite(value.minus_two_log_likelihood) || !value.gradient.allFinite()) {
        return std::nullopt;
    }
    return value;
}

Bounds MarginalLikelihood::bounds() const {
    const Bounds input = input_.bounds();
    const Bounds likelihood = outputs_.bounds();
    return {joined(std::log(1e-6), std::log(1e-2), input.lower, likelihood.lower),
            joined(std::log(1e2), std::log(1e3), input.upper, likelihood.upper)};
}

Eigen::VectorXd MarginalLikelihood::start(int index, NormalSource& random) const {
    constexpr std::array<double, 2> noise_ratios{1e-2, 1e-3};
    constexpr std::array<double, 2> length_scales{4, 8};
    const auto variant = static_cast<std::size_t>(index / 3) % 2;
    const Eigen::VectorXd input = input_.start(index, random);
    const Bounds likelihood = outputs_.bounds();
    return joined(std::log(noise_ratios[variant]), std::log(length_scales[variant]), input,
                  (likelihood.lower + likelihood.upper) / 2);
}

} // namespace dfdyn::tools
