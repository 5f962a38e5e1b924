// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/temporary_directory.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <string>

namespace dfdyn::tests {

/// A recording of two joints every `period_s`, whose torques depend on the present and the past motion.
inline std::string small_recording(int rows, double speed, double period_s = 0.05) {
    std::string text = "t,q1,q2,tau1,tau2\n";
    for (int row = 0; row < rows; ++row) {
        const double t = period_s * row;
        const double q1 = std::sin(speed * t) + 0.3 * std::sin(2.7 * speed * t);
        const double q2 = std::cos(1.3 * speed * t);
        const double v1 = speed * std::cos(speed * t);
        char line[160];
        std::snprintf(line, sizeof line, "%.3f,%.6f,%.6f,%.6f,%.6f\n", t, q1, q2,
                      std::sin(q1) + 0.3 * std::tanh(5 * v1) + 0.01 * std::sin(1000 * t),
                      2 + q2 * q1 + 0.1 * v1 + 0.01 * std::cos(1700 * t));
        text += line;
    }
    return text;
}

/// A plan for two such recordings, `train.csv` and `test.csv`, that runs in a fraction of a second.
inline nlohmann::json small_plan() {
    return nlohmann::json::parse(R"({
        "schema": "dfdyn.plan/1", "name": "small", "title": "A small experiment", "outputs": "tau",
        "training": {"log": "train.csv", "start_rows": 150},
        "tests": [{"log": "test.csv", "rows": 100, "count": 2}],
        "horizon": 5, "steady_after_s": 2, "draws": 2,
        "groups": [{"name": "first", "outputs": ["tau1"]}, {"name": "both", "outputs": ["tau1", "tau2"]}],
        "defaults": {"lags": 4, "features": 10, "likelihood_rows": 40, "starts": 1},
        "cases": [{"input": ["STD", "DFR"]}]
    })");
}

/// Writes the plan and its recordings; returns the path of the plan.
inline std::filesystem::path write_small_experiment(const TemporaryDirectory& directory,
                                                    const nlohmann::json& plan = small_plan()) {
    directory.write("train.csv", small_recording(300, 2));
    directory.write("test.csv", small_recording(220, 2.6));
    return directory.write("plan.json", plan.dump());
}

} // namespace dfdyn::tests
