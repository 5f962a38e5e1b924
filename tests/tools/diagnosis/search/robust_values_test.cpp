// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/robust_values.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/small_fitted_effects.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace robust_values_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A joint that swings, and effects at it in noise that is mostly slow.
struct SwingingJoint {
    MeasuredMotion measured = swing(1);
    SpectralRows rows{measured};
    MatrixXd of_noise = spectrum();
    VectorXd velocity = (1.3 * measured.time_s.array()).sin();
    VectorXd direction = velocity.array().sign();

    /// Noise of standard deviation 1, correlated over half a second like the residuals of real arms.
    VectorXd noise(std::mt19937_64& engine) const {
        constexpr double memory = 0.98; // per row
        std::normal_distribution<double> normal;
        VectorXd series(measured.time_s.size());
        double value = normal(engine);
        for (double& one : series) {
            one = value = memory * value + std::sqrt(1 - memory * memory) * normal(engine);
        }
        return series;
    }

    /// Spectrum of noise().
    MatrixXd spectrum() const {
        std::mt19937_64 engine(1);
        constexpr int series = 100;
        VectorXd sum = VectorXd::Zero(rows.bins());
        for (int i = 0; i < series; ++i) {
            sum += rows.analyse(noise(engine)).rowwise().squaredNorm();
        }
        return sum / (series * static_cast<double>(rows.frames()));
    }

    /// The model of effects with these columns, all of them chosen, after make_robust().
    FittedEffects explained(const VectorXd& torque, const std::vector<VectorXd>& effects) const {
        EffectRegression regression(rows, torque, rows.frames());
        std::vector<SpectralColumnPointer> columns;
        FittedEffects result;
        for (const VectorXd& series : effects) {
            const auto number = result.candidates.size();
            result.candidates.push_back(
                of_one_column("effect" + std::to_string(number + 1), "joint1", series));
            result.problem.candidates.push_back({{{{static_cast<Index>(number)}, is_anything}}});
            result.chosen.push_back({number, 0});
            columns.push_back(
                std::make_shared<const SpectralColumn>(rows, result.candidates.back().columns.front()));
        }
        regression.set_columns(columns);
        result.noise = of_noise;
        regression.set_noise(result.noise, {MatrixXd::Ones(rows.bins(), rows.frames())});
        result.problem.sums = regression.weighted_sums();
        result.fit = fit_effects(result.problem, result.chosen);
        result.named = result.fit;
        make_robust(result, regression);
        return result;
    }
};

} // namespace robust_values_test

using namespace robust_values_test;

TEST_CASE("values have the stated standard deviations if the effects are exact") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr int trials = 200;
    const SwingingJoint joint;
    const Eigen::Vector2d truth(4, 3);
    double distance = 0;
    for (int trial = 0; trial < trials; ++trial) {
        const VectorXd torque = truth[0] * joint.direction + truth[1] * joint.velocity + joint.noise(engine);
        const EffectFit found = joint.explained(torque, {joint.direction, joint.velocity}).values;
        const VectorXd error = found.coefficients - truth;
        distance += error.dot(found.covariance.ldlt().solve(error)) / 2 / trials;
    }
    CHECK(distance > 0.5);
    CHECK(distance < 2.9); // intervals are wider by 1.7: reach_of_95()
}

TEST_CASE(
    "dry friction that builds up after a reversal keeps its level and seldom gets a dependence on load") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr double level = 20;
    const SwingingJoint joint;
    const Eigen::ArrayXd load = (0.37 * joint.measured.time_s.array()).cos();
    // steeper at a higher load, which no effect of the catalogue models
    const VectorXd friction = level * ((30 + 21 * load) * joint.velocity.array()).tanh();
    const VectorXd by_load = load * joint.direction.array();
    constexpr int trials = 30;
    VectorXd by_noise(trials), values(trials);
    int with_load = 0;
    for (int trial = 0; trial < trials; ++trial) {
        const FittedEffects found =
            joint.explained(friction + joint.noise(engine), {joint.direction, joint.velocity, by_load});
        REQUIRE(std::ranges::find(found.chosen, 0U, &ChosenShape::candidate) != found.chosen.end());
        by_noise[trial] = found.named.coefficients[0];
        values[trial] = found.values.coefficients[0];
        with_load +=
            std::ranges::find(found.chosen, 2U, &ChosenShape::candidate) != found.chosen.end() ? 1 : 0;
    }
    CHECK(by_noise.mean() < 0.6 * level);
    CHECK(values.mean() == Approx(level).epsilon(0.1));
    CHECK(with_load < trials / 2); // with the weights of the noise: always
}
