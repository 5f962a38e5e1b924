// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/robot_options.hpp"

#include "tools/base/system/quiet.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/robot/urdf/read_robot.hpp"
#include "tools/simulation/scenario/scenario.hpp"

#include <cmath>

namespace dfdyn::tools {

void RobotOptions::add_to(CLI::App& command, bool required) {
    CLI::Option* const robot =
        command.add_option("--robot", urdf, "Robot")->required(required)->type_name("R.urdf");
    CLI::Option* const last = command.add_option("--tip", tip, "Last link of the chain")
                                  ->required(required)
                                  ->needs(robot)
                                  ->type_name("LINK");
    robot->needs(last);
    command.add_option("--base", base, "First link of the chain; default: the root")
        ->needs(robot)
        ->type_name("LINK");
    command
        .add_option("--ft-joint", ft_joint,
                    "Fixed joint that carries the F/T sensor, where it is not found by itself")
        ->needs(robot)
        ->type_name("JOINT");
    command
        .add_option(
            "--wrench-direction", wrench_direction,
            "Which side the measured wrench acts from and on; default: as the robot's file says, else "
            "child_to_parent")
        ->check(one_of({"child_to_parent", "parent_to_child"}))
        ->needs(robot);
    command
        .add_option("--gravity", gravity,
                    "Gravity in the frame of the robot's root, m/s^2; default: 0,0,-9.81")
        ->expected(3)
        ->delimiter(',')
        ->check(finite_number())
        ->needs(robot)
        ->type_name("X,Y,Z");
}

Robot RobotOptions::read(OutputKind outputs) const {
    ReadRobotOptions options;
    options.tip = tip;
    options.base = base;
    options.ft_joint = ft_joint;
    if (!wrench_direction.empty()) {
        options.parent_to_child = wrench_direction == "parent_to_child";
    }
    if (!gravity.empty()) {
        options.gravity = Eigen::Vector3d(gravity.data());
    }
    Robot robot = read_robot(urdf, options);
    for (const std::string& note : robot.notes) {
        print_note(shown(urdf) + ": " + note);
    }
    require_sensor(robot, outputs);
    return robot;
}

void RobotOptions::require_sensor(const Robot& robot, OutputKind outputs) const {
    if (outputs == OutputKind::wrench && !robot.sensor) {
        throw InputError(shown(urdf) + ": expected one F/T sensor at a fixed joint between link " +
                         in_quotes(robot.base) + " and link " + in_quotes(robot.tip) +
                         ", found none (--ft-joint names it)");
    }
}

ReadOptions columns_for(const Robot& robot, OutputKind outputs) {
    ReadOptions columns;
    columns.joint_count = robot.joints.size();
    columns.outputs = outputs;
    columns.joint_names = names_of_joints(robot);
    columns.prismatic = prismatic_joints(robot);
    return columns;
}

Robot read_scenario_robot(const std::filesystem::path& urdf, const std::filesystem::path& scenario) {
    const ScenarioChain chain = read_scenario_chain(scenario);
    RobotOptions reading;
    reading.urdf = urdf;
    reading.tip = chain.tip;
    reading.base = chain.base;
    reading.ft_joint = chain.ft_joint;
    reading.wrench_direction = chain.wrench_direction;
    reading.gravity = chain.gravity;
    // the scenario determines whether a sensor is needed
    Robot robot = reading.read(OutputKind::joint_torque);
    robot.tip_placement.translate(chain.tip_point);
    return robot;
}

} // namespace dfdyn::tools
