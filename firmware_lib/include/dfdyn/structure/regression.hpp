// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"

#include <concepts>

namespace dfdyn {

/// The columns of a structure for one motion, without a learner. `LearnedTorque` uses them for the reference,
/// which has no measurement to learn from.
///  - `push`, `ready`, `restart`: the window of past positions.
///  - `evaluate`: computes the columns; false if they are not usable.
///  - `predict_with(numbers, means)`: predicts with `weights` numbers from `copy_weights` of the
///    `Regression`.
template <class C, class Scalar, class Sample>
concept ColumnsOf = requires(C columns, const C& constant, Scalar* values, const Scalar* numbers,
                             const Sample& sample) {
    columns.restart();
    columns.push(sample);
    { constant.ready() } -> std::same_as<bool>;
    { columns.evaluate() } -> std::same_as<bool>;
    constant.predict_with(numbers, values);
    { C::weights } -> std::convertible_to<int>;
};

/// The part of a model that its structure defines: columns and learner of an estimator. All outputs are in
/// units of their noise and relative to their offset.
///  - `push`, `ready`, `restart`: the window of past positions.
///  - `evaluate`: computes the present columns; false if they are not usable.
///  - `predict(means)`: predicts at the present columns, m values.
///  - `predict_without_features(means)`: the physics' part of that prediction.
///  - `variances(ratios)`: 1 + the variance of each mean; returns φ'Pφ, the features' part.
///  - `begin(targets, noise_variance)`: after `predict` and when `idle()`, begins to learn the present
///    columns with m targets, measured with `noise_variance` in units of their noise variance.
///  - `reset_covariance()`: when `idle()`, begins to reset the covariance to the prior's. The means stay
///    (covariance resetting: G. C. Goodwin, K. S. Sin, "Adaptive Filtering, Prediction and Control", 1984).
///  - `advance(budget)`: continues either task; true when nothing is left to do.
///  - `sample_pending()`: a sample has begun and is not learned yet.
///  - `last_variance_ratios(ratios)`: `variances` at the last learned sample, before it was learned.
///  - `weight_count`, `copy_weights` (when idle), `predict_with(weights, means)`: the learned weights as
///    numbers, to predict with later.
///  - `reset()`: returns to the initial state.
template <class R, class Scalar, class Sample>
concept RegressionOf = requires(R regression, const R& constant, Scalar* values, const Scalar* numbers,
                                const Sample& sample, Budget& budget) {
    regression.reset();
    regression.restart();
    regression.push(sample);
    { constant.ready() } -> std::same_as<bool>;
    { regression.evaluate() } -> std::same_as<bool>;
    regression.predict(values);
    constant.predict_without_features(values);
    { constant.variances(values) } -> std::same_as<Scalar>;
    { constant.last_variance_ratios(values) } -> std::same_as<Scalar>;
    { constant.idle() } -> std::same_as<bool>;
    { constant.sample_pending() } -> std::same_as<bool>;
    regression.begin(numbers, *numbers);
    regression.reset_covariance();
    { regression.advance(budget) } -> std::same_as<bool>;
    { constant.weight_count() } -> std::same_as<int>;
    constant.copy_weights(values);
    constant.predict_with(numbers, values);
};

} // namespace dfdyn
