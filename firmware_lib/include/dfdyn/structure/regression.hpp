// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/budget.hpp"

#include <concepts>

namespace dfdyn {

/// The columns of a structure at one motion, without what is learned: where the arm *shall* go, there is
/// nothing to learn (`LearnedTorque`).
///  - `push`, `ready`, `restart`: the window of past positions.
///  - `evaluate`: computes the columns; false if they mean nothing.
///  - `predict_with(numbers, means)`: with `weights` numbers as `copy_weights` of the `Regression` gives
///  them.
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

/// What an estimator predicts with and learns: the part of a model that its structure brings. All outputs are
/// in units of their noise and about their offset.
///  - `push`, `ready`, `restart`: the window of past positions.
///  - `evaluate`: computes the present columns; false if they mean nothing.
///  - `predict(means)` at the present columns, m values.
///  - `predict_without_features(means)`: the part of the physics in that.
///  - `variances(ratios)`: 1 + the variance of each mean; returns φ'Pφ, the part of the features.
///  - `begin(targets, noise_variance)`: takes the present columns in, after `predict`, when `idle()`, with
///    targets measured with `noise_variance` in units of their noise variance.
///  - `reset_covariance()`: begins, when `idle()`, to set the covariance back to the prior's. The means stay
///    (covariance resetting: G. C. Goodwin, K. S. Sin, "Adaptive Filtering, Prediction and Control", 1984).
///  - `advance(budget)`: works on them; true when nothing is left to do.
///  - `sample_pending()`: they are not learned yet; `last_ratios(ratios)`: `variances` before the last sample
///    that was.
///  - `weight_count`, `copy_weights` (when idle), `predict_with(weights, means)`: what has been learned as
///    numbers, to predict with later.
///  - `reset()`: back to the start, all of it.
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
    { constant.last_ratios(values) } -> std::same_as<Scalar>;
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
