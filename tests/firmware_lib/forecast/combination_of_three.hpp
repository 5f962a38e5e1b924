// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/forecast_combination.hpp"

#include <array>
#include <random>

/// Combinations of three members with two outputs, for tests.
namespace forecast_combination_test {

using dfdyn::Extent;
using dfdyn::SnapshotResult;

constexpr int members = 3;
constexpr int outputs = 2;

template <class Scalar>
using Combination = dfdyn::ForecastCombination<Scalar, members, outputs>;

template <class Scalar>
using Values = std::array<Scalar, static_cast<std::size_t>(members) * outputs>;

template <class Scalar>
Combination<Scalar> combination(Scalar memory) {
    return {Extent<members>{}, Extent<outputs>{}, memory};
}

/// Standard deviations of the members' noise: 0.5, 1, 2 for the first output, 1 for the second.
template <class Scalar>
constexpr Values<Scalar> noise{Scalar(0.5), 1, 1, 1, 2, 1};

template <class Scalar>
Combination<Scalar> scaled_combination(Scalar memory) {
    return {Extent<members>{}, Extent<outputs>{}, memory, noise<Scalar>.data()};
}

/// Predictions of an output 0, with error deviations 1, 2, 4 (first output) and 3, 3, 0.3 (second).
template <class Scalar>
Values<Scalar> predictions(std::mt19937_64& engine) {
    constexpr std::array deviation{1.0, 3.0, 2.0, 3.0, 4.0, 0.3};
    std::normal_distribution<double> normal;
    Values<Scalar> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = static_cast<Scalar>(deviation[i] * normal(engine));
    }
    return values;
}

} // namespace forecast_combination_test
