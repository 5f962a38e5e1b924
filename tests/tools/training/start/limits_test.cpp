// SPDX-License-Identifier: Apache-2.0
// Limits that training derives from its data and from the efforts of the motors.
#include "tools/training/start/limits.hpp"

#include "tests/support/catch.hpp"

#include <array>
#include <numbers>

namespace limits_test {

using namespace dfdyn::tools;

TrainingData some_data() {
    TrainingData data;
    data.positions = Eigen::MatrixXd::Zero(3, 3);
    data.positions(1, 0) = -2;
    data.outputs = Eigen::MatrixXd::Zero(3, 3);
    data.outputs(0, 0) = 20;
    data.outputs(1, 0) = -30;
    data.outputs(2, 1) = 5;
    return data;
}

TEST_CASE("predictions are limited to three times and measurements to ten times the largest training value") {
    const LimitModel limits = limits_of(some_data());
    CHECK(limits.prediction[0] == 90);
    CHECK(limits.prediction[1] == 15);
    CHECK(limits.output[0] == 300);
    CHECK(limits.position_rad[0] == 20);
    CHECK(limits.position_rad[1] == Approx(2 * std::numbers::pi));
    CHECK(limits.prediction[2] > 0); // a channel that is always 0
    CHECK(limits.output[2] > 0);
}

TEST_CASE("a prediction is limited to the motor's effort if the data do not exceed it") {
    LimitModel limits = limits_of(some_data());
    // The second effort is ignored because the data exceed it.
    bound_by_efforts(limits, std::array{56.0, 4.0, 0.0});
    CHECK(limits.prediction[0] == 56);
    CHECK(limits.prediction[1] == 15);
    CHECK(limits.prediction[2] > 0);
}

TEST_CASE("an effort beyond three times the largest training value limits nothing") {
    LimitModel limits = limits_of(some_data());
    bound_by_efforts(limits, std::array{1000.0, 1000.0, 1000.0});
    CHECK(limits.prediction[0] == 90);
    CHECK(limits.prediction[1] == 15);
}

} // namespace limits_test
