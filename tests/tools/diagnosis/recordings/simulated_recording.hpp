// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/simulation/simulation.hpp"

#include <cmath>
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
        recording.time_s.push_back(sample.time_s);
        recording.time_ns.push_back(std::llround(sample.time_s * 1e9));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        recording.position.values.insert(recording.position.values.end(), sample.position.begin(),
                                         sample.position.end());
        recording.output.values.insert(recording.output.values.end(), sample.torque.begin(),
                                       sample.torque.end());
    }
    return recording;
}

} // namespace dfdyn::tests
