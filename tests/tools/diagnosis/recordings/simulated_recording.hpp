// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/tools/support/append_row.hpp"
#include "tools/simulation/simulation.hpp"

#include <string>

namespace dfdyn::tests {

/// Positions and joint torques of a simulated arm.
inline tools::Recording simulated_recording(const tools::Robot& robot, const tools::Scenario& scenario,
                                            const std::string& name) {
    const std::size_t joints = robot.joints.size();
    tools::Simulation simulation(robot, scenario);
    tools::Recording recording;
    recording.source = name;
    recording.position.names = tools::joint_names("q", joints);
    recording.output.names = tools::output_names(tools::OutputKind::joint_torque, joints);
    for (std::size_t row = 0; row < scenario.recording.samples; ++row) {
        const tools::SimulatedSample sample = simulation.next();
        append_row(recording, sample.time_s, sample.position, sample.torque);
    }
    return recording;
}

} // namespace dfdyn::tests
