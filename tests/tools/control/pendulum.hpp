// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/temporary_directory.hpp"
#include "tests/tools/simulation/small_arms.hpp"
#include "tools/can/description/bus_description.hpp"

#include <cmath>
#include <string>

namespace dfdyn::tests {

/// Mass (kg) and length (m) of the arm of the control tests.
inline constexpr double pendulum_mass = 1, pendulum_length = 0.5;
inline tools::Robot test_pendulum() { return pendulum(pendulum_mass, pendulum_length); }

/// Torque that balances gravity, N·m.
inline double weight(double position) { return pendulum_mass * 9.81 * pendulum_length * std::sin(position); }

inline tools::Scenario pendulum_scenario() {
    tools::Scenario scenario = quiet_scenario(1);
    scenario.controller.kind = tools::ControllerKind::feed_forward;
    scenario.controller.position_gain = tools::JointVector::Constant(1, 50);
    scenario.controller.velocity_gain = tools::JointVector::Constant(1, 5);
    scenario.actuators.torque_limit = tools::JointVector::Constant(1, 20);
    return scenario;
}

/// Triggers that assemble a sample.
inline const std::string at_sync = R"({"on": "sync"})";
inline const std::string at_timer = R"({"on": "timer", "delay_s": 0.002})";
inline const std::string at_set = R"({"on": "set"})";

/// A CiA 402 drive on node 1 at 1 kHz with efforts in units of 0.001 N·m; `trigger` is JSON.
inline tools::BusDescription one_drive(const std::string& trigger, const std::string& quantity = "tau") {
    const TemporaryDirectory directory;
    return tools::read_bus_description(directory.write(
        "bus.json", R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 1000, "trigger": )" +
                        trigger + R"(, "joints": {"family": "cia402",
 "position": {"pdo": "0x280", "length": 6, "start_bit": 0, "bits": 32},
 "effort": {"pdo": "0x280", "length": 6, "start_bit": 32, "bits": 16},
 "boards": [{"node": 1, "joint": 1, "counts_per_turn": 1048576, "effort_per_count": 0.001}]},
 "output": {"family": "efforts", "quantity": ")" +
                        quantity + "\"}}"));
}

} // namespace dfdyn::tests
