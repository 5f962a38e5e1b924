// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/found_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Parameters of a shape and their variances, from the gradient of each with respect to the coefficients.
struct ShapeParameters {
    std::vector<EffectParameter> values;
    Eigen::VectorXd variance;

    ShapeParameters(const Candidate& candidate, const EffectShape& shape, const Eigen::VectorXd& coefficients,
                    const Eigen::MatrixXd& covariance)
        : values(candidate.parameters(coefficients, shape)) {
        Eigen::MatrixXd gradient(static_cast<Eigen::Index>(values.size()), coefficients.size());
        for (Eigen::Index i = 0; i < coefficients.size(); ++i) {
            const double step = 1e-3 * std::sqrt(covariance(i, i)) + 1e-12;
            Eigen::VectorXd changed = coefficients;
            changed[i] += step;
            const std::vector<EffectParameter> moved = candidate.parameters(changed, shape);
            for (std::size_t k = 0; k < values.size(); ++k) {
                gradient(static_cast<Eigen::Index>(k), i) = (moved[k].value - values[k].value) / step;
            }
        }
        variance = (gradient * covariance * gradient.transpose()).diagonal().cwiseMax(0);
    }

    bool same_names(const ShapeParameters& other) const {
        return std::ranges::equal(values, other.values, {}, &EffectParameter::name, &EffectParameter::name);
    }
};

/// Parameters of a chosen effect, their variance for the chosen shape, and the additional variance from other
/// shapes with almost the same evidence.
ShapeParameters parameters_over_shapes(const FittedEffects& fitted_effects, std::size_t index) {
    const std::size_t number = fitted_effects.chosen[index].candidate;
    const Candidate& candidate = fitted_effects.candidates[number];
    std::vector<ChosenShape> named = fitted_effects.named_effects();
    const EffectShape& own_shape = candidate.shapes[named[index].shape];
    const ShapeParameters own(candidate, own_shape, fitted_effects.coefficients(index),
                              fitted_effects.covariance(index));
    const Eigen::Index first = fitted_effects.first_column(index);
    const Eigen::Index count = fitted_effects.coefficients(index).size();
    // parameters with the weights of the evidence, for comparison with the other shapes
    const ShapeParameters by_evidence(candidate, own_shape,
                                      fitted_effects.named.coefficients.segment(first, count),
                                      fitted_effects.named.covariance.block(first, first, count, count));
    ShapeParameters result = own;
    double total = 1;
    for (std::size_t shape = 0; shape < candidate.shapes.size(); ++shape) {
        named[index].shape = shape;
        const EffectShape& other_shape = candidate.shapes[shape];
        if (shape == fitted_effects.chosen[index].shape ||
            other_shape.columns.size() != own_shape.columns.size()) {
            continue;
        }
        const EffectFit fit = fit_effects(fitted_effects.problem, named);
        const ShapeParameters other(candidate, other_shape, fit.coefficients.segment(first, count),
                                    fit.covariance.block(first, first, count, count));
        const double odds = std::exp(std::min(0.0, fit.score - fitted_effects.named.score));
        if (fit.allowed && own.same_names(other)) {
            total += odds;
            for (Eigen::Index k = 0; k < own.variance.size(); ++k) {
                const auto i = static_cast<std::size_t>(k);
                const double apart = other.values[i].value - by_evidence.values[i].value;
                result.variance[k] += odds * (other.variance[k] + apart * apart);
            }
        }
    }
    result.variance /= total;
    return result;
}

} // namespace

std::vector<FoundParameter> found_parameters(const FittedEffects& fitted_effects, std::size_t index) {
    const ShapeParameters all = parameters_over_shapes(fitted_effects, index);
    std::vector<FoundParameter> result;
    for (std::size_t k = 0; k < all.values.size(); ++k) {
        const auto& [name, unit, value, null_value, systematic_relative_std] = all.values[k];
        const double of_data =
            reach_of_95(std::sqrt(all.variance[static_cast<Eigen::Index>(k)]), value - null_value);
        const double reach = std::hypot(of_data, deviations_of_95 * systematic_relative_std * value);
        result.push_back({name, unit, value, value - reach, value + reach});
    }
    return result;
}

double reach_of_95(double deviation, double effect) {
    constexpr double coloured =
        1.7; // measured ratio of interval widths to their formula: docs/results/diagnosis-panel.md
    constexpr double model_error = 0.04; // relative model error of large effects, measured as well
    return deviations_of_95 * std::hypot(coloured * deviation, model_error * effect);
}

FoundParameter parameter_within(std::string name, std::string unit, double value, double deviation) {
    const double reach = deviations_of_95 * deviation;
    return {std::move(name), std::move(unit), value, value - reach, value + reach};
}

FoundParameter positive_parameter(std::string name, std::string unit, double value, double deviation) {
    const auto below = [&](double limit) {
        return 0.5 * std::erfc((value - limit) / (deviation * std::numbers::sqrt2));
    };
    const auto quantile = [&](double share) {
        const double wanted = below(0) + share * (1 - below(0));
        double low = 0;
        double high = std::max(0.0, value) + 10 * deviation;
        for (int halving = 0; halving < 60; ++halving) {
            const double middle = (low + high) / 2;
            (below(middle) < wanted ? low : high) = middle;
        }
        return low;
    };
    return {std::move(name), std::move(unit), value, quantile(0.025), quantile(0.975)};
}

double deviation_of(const FoundParameter& parameter) {
    return (parameter.high - parameter.low) / (2 * deviations_of_95);
}

} // namespace dfdyn::tools
