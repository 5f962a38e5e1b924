// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/dfdyn.hpp"
#include "tests/firmware_lib/support/positions.hpp"
#include "tests/firmware_lib/support/two_link_arm.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

namespace dfdyn::tests {

/// A small model of a two-joint arm with two outputs.
template <class Scalar, class Input = DerivativeFreeReduced<6, 3>, int d = 8>
using TestModel = Model<Scalar, Joints<2, 2>, Input, RandomFourier<d>, Nonparametric<>>;

/// The physics of the test arm: rigid bodies, viscous friction, offsets.
template <class Motion = DerivativeFreeReduced<6, 3>>
using TestPhysics = Physics<Motion, two_link_column_count, ViscousFriction<2>, OutputOffset<2>>;

/// Models with that physics.
template <class Scalar, class Motion = DerivativeFreeReduced<6, 3>>
using TestParametric = Model<Scalar, Chain<2>, NoInput, NoFeatures, Parametric<TestPhysics<Motion>>>;
template <class Scalar, class Input = DerivativeFreeReduced<6, 3>, int d = 8, class Motion = Input>
using TestMean = Model<Scalar, Chain<2>, Input, RandomFourier<d>, SemiparametricMean<TestPhysics<Motion>>>;
template <class Scalar, class Input = DerivativeFreeReduced<6, 3>, int d = 8, class Motion = Input>
using TestKernel =
    Model<Scalar, Chain<2>, Input, RandomFourier<d>, SemiparametricKernel<TestPhysics<Motion>>>;

inline ArmState moving_arm(double time_s) {
    ArmState arm{};
    for (std::size_t i = 0; i < 2; ++i) {
        const double phase = 1.7 * static_cast<double>(i);
        for (const auto& [size, rate] : {std::pair{1.0, 2.3}, {0.5, 5.1 + phase}}) {
            const double angle = rate * time_s + phase;
            arm.position[i] += size * std::sin(angle);
            arm.velocity[i] += size * rate * std::cos(angle);
            arm.acceleration[i] -= size * rate * rate * std::sin(angle);
        }
    }
    return arm;
}

/// The state of an arm at rest at the position of the moving arm at `time_s`.
inline ArmState standing_arm(double time_s) { return {moving_arm(time_s).position, {0, 0}, {0, 0}}; }

inline constexpr double torque_noise = 0.05;

/// Returns the torques of the arm under test: those with the model's physics, or of the plain arm without
/// physics.
template <class Model>
std::array<double, 2> torques_of(const ArmState& arm) {
    if constexpr (Model::parameters == 0) {
        return {arm.torque(0), arm.torque(1)};
    } else {
        return two_link_torques(arm, Model::columns > 0);
    }
}

/// Returns the sensor readings of an arm at tick `tick`.
template <class Model>
typename Model::Sample sample_of(const ArmState& arm, std::int64_t tick, std::mt19937_64& engine) {
    using Scalar = typename Model::Scalar;
    std::normal_distribution<double> noise(0, torque_noise);
    const std::array<double, 2> torques = torques_of<Model>(arm);
    typename Model::Sample sample{};
    sample.time_ns = tick * period_ns;
    sample.output_valid = true;
    for (std::size_t i = 0; i < 2; ++i) {
        const auto joint = static_cast<int>(i);
        sample.position[joint] = static_cast<Scalar>(arm.position[i]);
        sample.output[joint] = static_cast<Scalar>(torques[i] + noise(engine));
        if constexpr (requires { sample.velocity; }) {
            sample.velocity[joint] = static_cast<Scalar>(arm.velocity[i]);
            sample.acceleration[joint] = static_cast<Scalar>(arm.acceleration[i]);
        }
    }
    return sample;
}

/// Returns the sample of the moving arm at tick `tick`.
template <class Model>
typename Model::Sample moving_sample(std::int64_t tick, std::mt19937_64& engine) {
    return sample_of<Model>(moving_arm(period_s * static_cast<double>(tick)), tick, engine);
}

/// Sets the rows of an input with three of them to the filters of DFSR.
template <class Input, class Constants>
void set_filters(Constants& input, const StructuredFilters<double>& filters) {
    std::array<double, 3 * (Input::lags + 1)> rows{};
    structured_rows<double>(filters, Input::lags, rows.data());
    to_difference_form(rows.data(), 3, Input::lags, rows.data());
    std::transform(rows.begin(), rows.end(), input.rows.begin(), [](double value) {
        return static_cast<std::remove_cvref_t<decltype(input.rows[0])>>(value);
    });
}

/// Sets the constants of an input such that its elements are (q, q̇, q̈) of each joint times `sizes`; other
/// elements stay unchanged.
template <class Input, class Constants>
void set_input(Constants& input, const std::array<double, 3>& sizes) {
    constexpr double beta = 0.05; // so small that the tail vanishes after six lags
    constexpr double alpha1 = (1 - beta) / period_s;
    constexpr double alpha2 = (1 - beta) / (period_s * period_s);
    using Scalar = std::remove_cvref_t<decltype(input.scale[0])>;
    for (int element = 0; element < input.scale.size(); ++element) {
        const auto row = static_cast<std::size_t>(element % 3);
        input.scale[element] = static_cast<Scalar>(Input::features_per_joint == 3 ? sizes[row] : 1);
    }
    if constexpr (requires { input.rows; }) {
        set_filters<Input>(input, {alpha1, alpha2, beta, beta});
    }
    if constexpr (requires { input.position_noise_bound; }) {
        input.position_noise_bound = Scalar(1e-5);
    }
}

/// Sets prior and forgetting of all learners of a structure.
template <class Scalar, class Learner>
void set_learner(Learner& learner, double forgetting_factor) {
    const auto lambda = static_cast<Scalar>(forgetting_factor);
    if constexpr (requires { learner.common; }) {
        learner.features = {1000, lambda, nullptr};
        learner.common = {100, lambda, nullptr};
    } else if constexpr (requires { learner.residual; }) {
        learner.residual = {1000, lambda, nullptr};
    } else {
        learner.prior_variance = 1000;
        learner.forgetting_factor = lambda;
    }
}

/// Sets chain and columns of a test model's physics. SP's fixed parameters deviate slightly from the true
/// ones.
template <class Model>
void set_physics(typename Model::Constants& constants) {
    using Scalar = typename Model::Scalar;
    set_two_links(constants.physics.chain);
    set_input<typename Model::Physics::Motion>(constants.physics.motion, {1, 1, 1});
    constants.physics.effects = {{{{0, 1}}}, {{{0, 1}}}};
    std::ranges::copy(two_link_columns, constants.physics.selected.begin());
    for (Scalar& scale : constants.physics.column_scale) {
        scale = 1;
    }
    constants.physics.output_gain = {{1, 1}};
    std::ranges::fill(constants.physics.motion_limit, Scalar(1e6));
    if constexpr (requires { constants.learner.parameters_of_mean; }) {
        for (std::size_t c = 0; c < two_link_parameters.size(); ++c) {
            constants.learner.parameters_of_mean[static_cast<int>(c)] =
                static_cast<Scalar>(1.1 * two_link_parameters[c]);
        }
    }
}

/// Returns the constants of a test model with random frequencies.
template <class Model>
typename Model::Constants make_constants(std::mt19937_64& engine, double forgetting_factor = 1) {
    using Scalar = typename Model::Scalar;
    typename Model::Constants constants{};
    constants.identity = 0x1234;
    constants.gap_ns = 3 * period_ns / 2;
    constants.period_ns = period_ns;
    if constexpr (Model::columns > 0) {
        set_input<typename Model::Input>(constants.input, {1, 0.3, 0.05});
        std::normal_distribution<double> normal(0, 0.4);
        for (Scalar& frequency : constants.features.frequencies) {
            frequency = static_cast<Scalar>(normal(engine));
        }
        constants.features.amplitude = static_cast<Scalar>(1 / std::sqrt(Model::Features::count));
    }
    if constexpr (Model::parameters > 0) {
        set_physics<Model>(constants);
    }
    constants.output_offset = {{Scalar(0.25), Scalar(-0.5)}};
    constants.output_noise_std = {{Scalar(0.05), Scalar(0.08)}};
    constants.position_limit = {{10, 10}};
    constants.output_limit = {{100, 100}};
    constants.innovation_limit = std::numeric_limits<Scalar>::max(); // learn every sample
    set_learner<Scalar>(constants.learner, forgetting_factor);
    return constants;
}

/// Returns the snapshot of an estimator, which contains its whole learned state.
template <class Estimator>
std::vector<std::byte> snapshot_of(const Estimator& estimator) {
    std::vector<std::byte> bytes(estimator.snapshot_bytes());
    if (estimator.snapshot(bytes) != SnapshotResult::ok) {
        bytes.clear();
    }
    return bytes;
}

/// Returns the learned state of a regression as plain numbers.
template <class Model>
std::vector<typename Model::Scalar> weights_of(const Estimator<Model>& estimator) {
    std::vector<typename Model::Scalar> weights(
        static_cast<std::size_t>(estimator.regression().weight_count()));
    estimator.regression().copy_weights(weights.data());
    return weights;
}

template <class Scalar, int m>
bool same(const Storage<Scalar, m>& a, const Storage<Scalar, m>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

/// Returns true if two estimates are bitwise equal.
template <class Scalar, int m>
bool same(const Estimate<Scalar, m>& a, const Estimate<Scalar, m>& b) {
    return same(a.prediction, b.prediction) && same(a.standard_deviation, b.standard_deviation) &&
           same(a.innovation, b.innovation) &&
           a.normalised_innovation_squared == b.normalised_innovation_squared &&
           a.status.prediction == b.status.prediction && a.status.learning == b.status.learning;
}

} // namespace dfdyn::tests
