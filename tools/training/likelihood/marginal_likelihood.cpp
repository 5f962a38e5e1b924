// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/marginal_likelihood.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/training/likelihood/covariance_factor.hpp"
#include "tools/training/likelihood/gaussian_kernel.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns dL/dC, with all entries.
MatrixXd covariance_gradient(const Evidence& evidence, const CovarianceFactor& factor) {
    MatrixXd gradient = evidence.count * factor.inverse();
    gradient.noalias() -=
        evidence.directions * evidence.weights.asDiagonal() * evidence.directions.transpose();
    return gradient;
}

} // namespace

VectorXd joined(double log_noise_ratio, double log_length_scale, const VectorXd& rest) {
    VectorXd result(kernel_parameters + rest.size());
    result << log_noise_ratio, log_length_scale, rest;
    return result;
}

Hyperparameters MarginalLikelihood::split(const VectorXd& theta) const {
    const Eigen::Index inputs = input_.bounds().lower.size();
    return {std::exp(theta[0]), std::exp(theta[1]), theta.segment(kernel_parameters, inputs),
            theta.tail(theta.size() - kernel_parameters - inputs)};
}

std::optional<LikelihoodValue> MarginalLikelihood::evaluate(const VectorXd& theta) const {
    const Hyperparameters parameters = split(theta);
    const MatrixXd inputs = input_.inputs(parameters.input);
    const MatrixXd kernel = gaussian_kernel(inputs, parameters.length_scale);
    MatrixXd covariance = kernel;
    covariance.diagonal().array() += parameters.noise_ratio;
    const std::optional<CovarianceFactor> factor = CovarianceFactor::of(std::move(covariance));
    if (!factor) {
        return std::nullopt;
    }
    const auto evidence = outputs_.evaluate(*factor, theta.tail(theta.size() - kernel_parameters));
    if (!evidence) {
        return std::nullopt;
    }
    const MatrixXd slope = covariance_gradient(*evidence, *factor);
    const KernelGradient gradient = gaussian_kernel_pull_back(inputs, parameters.length_scale, kernel, slope);
    LikelihoodValue value{
        evidence->minus_two_log_likelihood, {}, evidence->output_variance, evidence->physics};
    value.gradient = joined(parameters.noise_ratio * slope.trace(), gradient.log_length_scale,
                            evidence->parameter_gradient);
    value.gradient.segment(kernel_parameters, parameters.input.size()) +=
        input_.pull_back(parameters.input, gradient.inputs);
    return finite_or_nothing(std::move(value));
}

Bounds MarginalLikelihood::bounds() const {
    const Bounds input = input_.bounds();
    const Bounds own = outputs_.bounds();
    return {joined(std::log(noise_ratio_least), std::log(length_scale_least),
                   concatenated(input.lower, own.lower)),
            joined(std::log(noise_ratio_most), std::log(length_scale_most),
                   concatenated(input.upper, own.upper))};
}

VectorXd MarginalLikelihood::start(int index, NormalSource& random) const {
    constexpr std::array<double, 2> noise_ratios{1e-2, 1e-3};
    constexpr std::array<double, 2> length_scales{4, 8};
    const auto variant = static_cast<std::size_t>(index / 3) % 2;
    const VectorXd input = input_.start(index, random);
    return joined(std::log(noise_ratios[variant]), std::log(length_scales[variant]),
                  concatenated(input, outputs_.start(input)));
}

std::vector<std::string> bounds_reached(double noise_ratio, double length_scale) {
    struct Bound {
        double value, bound;
        const char* meaning;
    };
    constexpr double close = 0.01; // relative
    std::vector<std::string> sentences;
    for (const Bound& one :
         {Bound{length_scale, length_scale_least,
                "the length scale is at its lower bound: the features do not generalise to new motions"},
          Bound{length_scale, length_scale_most,
                "the length scale is at its upper bound: the features are nearly linear functions"},
          Bound{
              noise_ratio, noise_ratio_least,
              "rho^2/sigma^2 is at its upper bound: the outputs have hardly any noise, or the model fits it"},
          Bound{
              noise_ratio, noise_ratio_most,
              "rho^2/sigma^2 is at its lower bound: the features explain hardly anything of the outputs"}}) {
        if (std::abs(one.value / one.bound - 1) < close) {
            sentences.emplace_back(one.meaning);
        }
    }
    return sentences;
}

} // namespace dfdyn::tools
