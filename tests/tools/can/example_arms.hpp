// SPDX-License-Identifier: Apache-2.0
// Arms of the families' examples.
#pragma once

#include "tests/tools/can/bus_check_support.hpp"
#include "tools/can/description/bus_fields.hpp"
#include "tools/can/families/family_catalogue.hpp"

namespace dfdyn::tests {

/// Joints of one family with the sensor of another, or with their own efforts.
inline BusDescription example_arm(const tools::JointFamily& joints, std::string_view output) {
    const std::string trigger = joints.sync != nullptr ? "sync" : "set";
    return described(R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 500,
        "trigger": {"on": ")" +
                     trigger + R"("}, "joints": )" + std::string(joints.example) + R"(, "output": )" +
                     std::string(output) + "}");
}

/// All arms: each family of joints with each sensor, and with its own efforts if it measures them. With
/// `once`: each family in as few arms as possible.
inline std::vector<BusDescription> example_arms(bool once = false) {
    std::vector<BusDescription> arms;
    bool sensors_seen = false;
    for (const tools::JointFamily& joints : tools::joint_families()) {
        if (joints.example.empty()) {
            continue;
        }
        std::vector<BusDescription> with_sensor;
        for (const tools::SensorFamily& sensor : tools::sensor_families()) {
            if (!sensor.example.empty()) {
                with_sensor.push_back(example_arm(joints, sensor.example));
            }
        }
        const bool efforts = tools::measures_efforts(with_sensor.front().boards);
        const bool all = !once || !sensors_seen;
        if (all || !efforts) {
            arms.insert(arms.end(), with_sensor.begin(),
                        all ? with_sensor.end() : std::next(with_sensor.begin()));
        }
        if (efforts) {
            arms.push_back(example_arm(joints, R"({"family": "efforts", "quantity": "tau"})"));
        }
        sensors_seen = true;
    }
    return arms;
}

} // namespace dfdyn::tests
