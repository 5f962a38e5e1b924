// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/training_data.hpp"

#include "dfdyn/input/adaptive_window.hpp"
#include "tests/support/catch.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tools/base/text/error.hpp"
#include "tools/training/data/recorded_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace training_data_test {

namespace tools = dfdyn::tools;
using tools::InputKind;

tools::TrainingData small_data() {
    tools::NormalSource random(1);
    return dfdyn::tests::arm_data(30, 2, 3, random);
}

std::string message(const tools::TrainingData& data, InputKind kind = InputKind::STD) {
    try {
        tools::check_training_data(data, kind);
    } catch (const tools::InputError& error) {
        return error.what();
    }
    return "";
}

/// One joint at 5 kHz.
tools::Recording fast_recording() {
    tools::Recording recording;
    recording.source = "made up";
    recording.position.names = {"q1"};
    recording.output.names = {"i1"};
    for (int row = 0; row < 600; ++row) {
        const double t = 2e-4 * row;
        recording.time_s.push_back(t);
        recording.time_ns.push_back(200'000L * row);
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        recording.position.values.push_back(1e-4 * std::round(1e4 * (std::sin(5 * t) + 0.1 * t)));
        recording.output.values.push_back(0);
    }
    return recording;
}

TEST_CASE("estimated derivatives are those of the firmware's adaptive window") {
    const tools::Recording recording = fast_recording();
    tools::TrainingData data = tools::gather_training_data({&recording, 1});
    tools::estimate_derivatives(data, {&recording, 1}, 40, 2e-4);
    for (const Eigen::Index row : {3, 57, 599}) {
        CAPTURE(row);
        std::vector<double> ages, values;
        for (Eigen::Index lag = 0; lag <= std::min<Eigen::Index>(row, 40); ++lag) {
            ages.push_back(-2e-4 * static_cast<double>(lag));
            values.push_back(data.positions(row - lag, 0));
        }
        const dfdyn::AdaptiveWindow<double> window(ages.data(), values.data(), 1,
                                                   static_cast<int>(values.size()), 2e-4);
        CHECK(data.velocities(row, 0) == Approx(window.velocity()).epsilon(1e-9).margin(1e-9));
        CHECK(data.accelerations(row, 0) == Approx(window.acceleration()).epsilon(1e-9).margin(1e-9));
    }
}

TEST_CASE("valid training data pass") { CHECK(message(small_data()).empty()); }

TEST_CASE("invalid training data are rejected with row and column") {
    tools::TrainingData data = small_data();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    SECTION("position") {
        data.positions(7, 1) = nan;
        CHECK(message(data) ==
              "training data: row 7, position of joint 2: expected a finite number, found nan");
    }
    SECTION("output") {
        data.outputs(0, 2) = std::numeric_limits<double>::infinity();
        CHECK(message(data) == "training data: row 0, output 3: expected a finite number, found inf");
    }
    SECTION("velocity") {
        data.velocities(3, 0) = nan;
        CHECK(message(data) ==
              "training data: row 3, velocity of joint 1: expected a finite number, found nan");
    }
    SECTION("acceleration") {
        data.accelerations(3, 0) = nan;
        CHECK(message(data) ==
              "training data: row 3, acceleration of joint 1: expected a finite number, found nan");
    }
}

TEST_CASE("training data of the wrong shape are rejected") {
    tools::TrainingData data = small_data();
    SECTION("outputs") {
        data.outputs.conservativeResize(29, 3);
        CHECK(message(data) == "training data: expected outputs of 30 x 3, found 29 x 3");
    }
    SECTION("gaps") {
        data.gap_before.pop_back();
        CHECK(message(data) == "training data: expected 30 gap flags, found 29");
    }
    SECTION("names") {
        data.output_names.pop_back();
        CHECK(message(data) == "training data: expected 3 output names, found 2");
    }
    SECTION("accelerations") {
        data.accelerations.resize(0, 0);
        CHECK(message(data) == "training data: expected accelerations of 30 x 2, found 0 x 0");
    }
    SECTION("no output") {
        data.outputs.resize(30, 0);
        CHECK(message(data) == "training data: expected at least one joint and one output, found 2 and 0");
    }
}

TEST_CASE("derivatives are not required if the input does not use them") {
    tools::TrainingData data = small_data();
    data.velocities.resize(0, 0);
    data.accelerations.setConstant(std::numeric_limits<double>::quiet_NaN());
    CHECK(message(data, InputKind::DFR).empty());
}

} // namespace training_data_test
