// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/temporary_directory.hpp"
#include "tools/can/log/bus_traffic.hpp"
#include "tools/model/model.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace dfdyn::tests {

inline const std::string bus_folder = DFDYN_TEST_DATA_DIR "/can/";

/// A model without any learning, from position with velocity and acceleration by differences.
inline tools::TrainedModel unlearned_model(std::mt19937_64& engine, int joints, double sample_period_s,
                                           const std::vector<std::string>& outputs, int features) {
    std::normal_distribution<double> normal;
    tools::TrainedModel model;
    model.joints = joints;
    model.sample_period_s = sample_period_s;
    model.forgetting_factor = 1;
    model.input.kind = tools::InputKind::DFR;
    model.input.lags = 4;
    model.input.rows_per_joint = 3;
    model.input.rows = {1, 0, 0, 0, 0, 0.5, 0, 0, 0, -0.5, 1, 0, -2, 0, 1};
    for (int joint = 0; joint < joints; ++joint) {
        model.input.scale.insert(model.input.scale.end(), {0.5, 20, 200});
    }
    std::vector<double> omega(static_cast<std::size_t>(features * joints * 3));
    std::ranges::generate(omega, [&] { return normal(engine); });
    model.features = {false, features, 1, omega, 2};
    const std::vector<double> ones(outputs.size(), 1);
    model.outputs = {outputs, std::vector<double>(outputs.size()), std::vector<double>(outputs.size(), 0.1),
                     10};
    model.limits = {std::vector<double>(static_cast<std::size_t>(joints), 7),
                    std::vector<double>(outputs.size(), 1e6), 1e9, 100};
    return model;
}

/// The description of the iCub's arm with another sample rate.
inline std::string icub_arm_at(int rate_hz) {
    std::string text = file_content(bus_folder + "icub_arm_strain.json");
    const std::string rate = "\"sample_rate_hz\": 1000";
    return text.replace(text.find(rate), rate.size(), "\"sample_rate_hz\": " + std::to_string(rate_hz));
}

/// Writes a log of the iCub's arm under a wrench, by default 0.5 s at 1 kHz.
struct IcubLog {
    TemporaryDirectory directory;
    std::filesystem::path path = directory.path() / "run.log";
    tools::BusDescription bus;
    tools::TrainedModel model;

    explicit IcubLog(int rows = 500, int rate_hz = 1000) {
        bus = tools::read_bus_description(directory.write("bus.json", icub_arm_at(rate_hz)));
        std::mt19937_64 engine(1);
        model =
            unlearned_model(engine, 4, 1.0 / rate_hz, tools::output_names(tools::OutputKind::wrench, 4), 20);
        tools::Recording recording;
        recording.source = "made up";
        recording.position.names = tools::joint_names("q", 4);
        recording.output.names = tools::output_names(tools::OutputKind::wrench, 4);
        std::normal_distribution<double> noise(0, 0.3);
        for (int row = 0; row < rows; ++row) {
            const double t = 1.0 / rate_hz * row;
            recording.time_ns.push_back(1'000'000'000LL / rate_hz * row);
            for (int i = 0; i < 4; ++i) {
                recording.position.values.push_back(0.3 * i + 0.5 * std::sin(3 * t + i));
            }
            for (int k = 0; k < 6; ++k) {
                recording.output.values.push_back(5 * std::sin(3 * t + k) + noise(engine));
            }
        }
        write_bus_log(recording, bus, {}, path);
    }

    /// The log without the lines that contain `word`.
    std::filesystem::path without(const std::string& word) const {
        std::istringstream lines(file_content(path));
        std::string text;
        for (std::string line; std::getline(lines, line);) {
            text += line.find(word) == std::string::npos ? line + "\n" : "";
        }
        return directory.write("without.log", text);
    }
};

} // namespace dfdyn::tests
