// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/dfdyn.hpp"
#include "tests/firmware_lib/support/positions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace dfdyn::tests {

/// A small model of a two-jointed arm with two outputs.
template <class Scalar, class Input = DerivativeFreeReduced<6, 3>, int d = 8,
          template <class, int, int> class Form = UdCovariance>
using TestModel = Model<Scalar, Joints<2, 2>, Input, RandomFourier<d>, Nonparametric<Form>>;

/// Where a two-jointed arm is at a time, and the torque that takes it there.
struct ArmState {
    std::array<double, 2> position, velocity, acceleration;

    [[nodiscard]] double torque(std::size_t joint) const {
        return 2 * std::sin(position[joint]) + 0.3 * std::cos(position[0] + position[1]) +
               0.2 * velocity[joint] + 0.05 * acceleration[joint];
    }
};

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

/// An arm that stands where the moving arm would be at `time_s`.
inline ArmState standing_arm(double time_s) { return {moving_arm(time_s).position, {0, 0}, {0, 0}}; }

inline constexpr double torque_noise = 0.05;

/// What the sensors of an arm show, at tick number `tick`.
template <class Model>
typename Model::Sample sample_of(const ArmState& arm, std::int64_t tick, std::mt19937_64& engine) {
    using Scalar = typename Model::Scalar;
    std::normal_distribution<double> noise(0, torque_noise);
    typename Model::Sample sample{};
    sample.time_ns = tick * period_ns;
    sample.output_valid = true;
    for (std::size_t i = 0; i < 2; ++i) {
        const auto joint = static_cast<int>(i);
        sample.position[joint] = static_cast<Scalar>(arm.position[i]);
        sample.output[joint] = static_cast<Scalar>(arm.torque(i) + noise(engine));
        if constexpr (requires { sample.velocity; }) {
            sample.velocity[joint] = static_cast<Scalar>(arm.velocity[i]);
            sample.acceleration[joint] = static_cast<Scalar>(arm.acceleration[i]);
        }
    }
    return sample;
}

/// The sample of the moving arm at tick number `tick`.
template <class Model>
typename Model::Sample moving_sample(std::int64_t tick, std::mt19937_64& engine) {
    return sample_of<Model>(moving_arm(period_s * static_cast<double>(tick)), tick, engine);
}

/// Constants of a model's input such that its elements are of size 1 on the moving arm.
template <class Model>
void set_input(typename Model::InputConstants& input) {
    using Scalar = typename Model::Scalar;
    constexpr double beta = 0.05; // so small that six lags leave nothing of the tail
    constexpr double alpha1 = (1 - beta) / period_s;
    constexpr double alpha2 = (1 - beta) / (period_s * period_s);
    constexpr int per_joint = Model::Input::features_per_joint;
    for (int element = 0; element < input.scale.size(); ++element) {
        constexpr double sizes[] = {1, 0.3, 0.05};
        input.scale[element] = static_cast<Scalar>(per_joint == 3 ? sizes[element % 3] : 1);
    }
    if constexpr (requires { input.rows; }) {
        std::array<double, 3 * (Model::Input::lags + 1)> rows{};
        structured_rows<double>({alpha1, alpha2, beta, beta}, Model::Input::lags, rows.data());
        to_difference_form(rows.data(), 3, Model::Input::lags, rows.data());
        std::transform(rows.begin(), rows.end(), input.rows.begin(),
                       [](double value) { return static_cast<Scalar>(value); });
    }
    if constexpr (requires { input.filters; }) {
        input.filters = {Scalar(alpha1), Scalar(alpha2), Scalar(beta), Scalar(beta)};
    }
    if constexpr (requires { input.position_noise_bound; }) {
        input.position_noise_bound = Scalar(1e-5);
    }
}

/// The constants of a test model with random frequencies.
template <class Model>
typename Model::Constants make_constants(std::mt19937_64& engine, double forgetting_factor = 1) {
    using Scalar = typename Model::Scalar;
    typename Model::Constants constants{};
    constants.identity = 0x1234;
    constants.gap_ns = 3 * period_ns / 2;
    set_input<Model>(constants.input);
    std::normal_distribution<double> normal(0, 0.4);
    for (Scalar& frequency : constants.features.frequencies) {
        frequency = static_cast<Scalar>(normal(engine));
    }
    constants.features.amplitude = static_cast<Scalar>(1 / std::sqrt(Model::Features::count));
    constants.output_offset = {{Scalar(0.25), Scalar(-0.5)}};
    constants.output_noise_std = {{Scalar(0.05), Scalar(0.08)}};
    constants.position_limit = {{10, 10}};
    constants.output_limit = {{100, 100}};
    constants.innovation_limit = std::numeric_limits<Scalar>::max(); // learn everything
    constants.learner.prior_variance = 1000;
    constants.learner.forgetting_factor = static_cast<Scalar>(forgetting_factor);
    return constants;
}

/// The snapshot of an estimator: all that it has learned.
template <class Estimator>
std::vector<std::byte> snapshot_of(const Estimator& estimator) {
    std::vector<std::byte> bytes(estimator.snapshot_bytes());
    if (estimator.snapshot(bytes) != SnapshotResult::ok) {
        bytes.clear();
    }
    return bytes;
}

template <class Scalar, int m>
bool same(const Storage<Scalar, m>& a, const Storage<Scalar, m>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

/// Whether two estimates are the same in every bit.
template <class Scalar, int m>
bool same(const Estimate<Scalar, m>& a, const Estimate<Scalar, m>& b) {
    return same(a.prediction, b.prediction) && same(a.standard_deviation, b.standard_deviation) &&
           same(a.innovation, b.innovation) &&
           a.normalised_innovation_squared == b.normalised_innovation_squared &&
           a.status.prediction == b.status.prediction && a.status.learning == b.status.learning;
}

} // namespace dfdyn::tests
