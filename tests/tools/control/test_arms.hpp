// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/tools/control/faulty_loop.hpp"
#include "tools/commands/options/robot_options.hpp"

#include <string>
#include <utility>

namespace faulty_loop_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
namespace hal = dfdyn::hal;

inline const std::string data = DFDYN_TEST_DATA_DIR;

/// Robot and scenario from the project's test data.
struct Arm {
    Robot robot;
    Scenario scenario;
};
inline Arm read_arm(const std::string& urdf, const std::string& scenario) {
    const std::string path = data + "/scenarios/" + scenario;
    Robot robot = read_scenario_robot(data + "/robots/" + urdf, path);
    Scenario read = read_scenario(path, robot);
    return {std::move(robot), std::move(read)};
}
inline Arm ur5() { return read_arm("ur5/ur5_robot.urdf", "ur5_loop.json"); }
inline Arm icub() { return read_arm("icub_right_arm/icub_right_arm.urdf", "icub_loop.json"); }
inline BusDescription bus_of(const std::string& name) { return read_bus_description(data + "/can/" + name); }

} // namespace faulty_loop_test
