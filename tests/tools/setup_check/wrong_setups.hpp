// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"
#include "tools/setup_check/setup_finding.hpp"

#include <functional>
#include <string>
#include <vector>

namespace dfdyn::tests {

/// A recording with the robot that belongs to it.
struct Setup {
    std::string name;
    tools::OutputKind outputs;
    tools::Robot robot;
    tools::Recording recording;
};

/// A mistake in a set-up, and the code with which it must be refused.
struct WrongSetup {
    std::string name;
    tools::SetupFault fault;
    std::function<void(Setup&)> make;
};

/// Mistakes in signs, order, units, clock, channels and the robot's file, for an arm of three joints or more.
/// `other` is a different robot with as many joints.
std::vector<WrongSetup> wrong_setups(const tools::Robot& other, tools::OutputKind outputs);

} // namespace dfdyn::tests
