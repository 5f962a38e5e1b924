// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/suites/bench_arm.hpp"

#include "tools/base/recording/recording.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace dfdyn::tools {

namespace {

constexpr int lags = 10;
constexpr int features = 100; // 2d = 200

std::vector<double> random_numbers(std::mt19937_64& engine, std::size_t count, double deviation) {
    std::normal_distribution<double> normal(0, deviation);
    std::vector<double> numbers(count);
    std::ranges::generate(numbers, [&] { return normal(engine); });
    return numbers;
}

} // namespace

TrainedModel BenchArm::model() {
    std::mt19937_64 engine(4);
    TrainedModel model;
    model.joints = joints;
    model.sample_period_s = period_s;
    model.input.lags = lags;
    model.input.rows_per_joint = 3;
    model.input.rows = random_numbers(engine, 3 * (lags + 1), 0.3);
    model.input.scale.assign(3 * joints, 1.0);
    model.features = {false, features, 4, random_numbers(engine, features * 3 * joints, 1), 4};
    model.outputs = {joint_names("tau", joints), std::vector<double>(joints, 0.0),
                     std::vector<double>(joints, 0.1), 100};
    model.limits = {std::vector<double>(joints, 10.0), std::vector<double>(joints, 1e3), 1e9, 0};
    return model;
}

void BenchArm::move_to(std::size_t row) {
    time_s_ = period_s * static_cast<double>(row);
    for (std::size_t i = 0; i < joints; ++i) {
        const double pace = 0.3 + 0.17 * static_cast<double>(i);
        position_[i] = std::sin(pace * time_s_) + 0.5 * std::sin(2.7 * pace * time_s_);
        torque_[i] = 5 * std::sin(position_[i]) + 0.3 * std::cos(pace * time_s_);
    }
}

} // namespace dfdyn::tools
