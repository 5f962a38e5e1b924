// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/tools/support/append_row.hpp"
#include "tools/simulation/simulation.hpp"

#include <cstddef>

namespace dfdyn::tests {

/// Returns a scenario's recorded positions and motor currents. Its actuators must have torque constants.
inline tools::Recording simulated_currents(const tools::Robot& robot, const tools::Scenario& scenario) {
    tools::Recording recording;
    recording.position.names = tools::joint_names("q", robot.joints.size());
    recording.output.names = tools::output_names(tools::OutputKind::motor_current, robot.joints.size());
    tools::Simulation simulation(robot, scenario);
    for (std::size_t row = 0; row < scenario.recording.samples; ++row) {
        const tools::SimulatedSample sample = simulation.next();
        append_row(recording, sample.time_s, sample.position, scenario.torque_sensor.current(sample.torque));
    }
    return recording;
}

} // namespace dfdyn::tests
