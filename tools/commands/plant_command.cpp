// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/command.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/commands/options/stop_signal.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/control/loop_setup.hpp"
#include "tools/control/report/loop_summary.hpp"

#include <iostream>
#include <memory>

namespace dfdyn::tools {

namespace {

struct PlantOptions {
    std::filesystem::path robot, scenario, bus;
    std::string interface;
    double duration_s = 0;
};

int run(const PlantOptions& options) {
    const Robot robot = read_scenario_robot(options.robot, options.scenario);
    const Scenario scenario = read_scenario(options.scenario, robot);
    const BusDescription bus = read_bus_description(options.bus);
    check_bus(bus, robot, scenario);
    const double period_s = 1 / bus.joints.rate_hz;
    const JointVector start = make_task(scenario.task, robot, period_s, scenario.seed)->next().position;
    SimulatedPlant plant(robot, scenario, start);
    PlantPort port(bus, scenario.torque_sensor);
    const PaceOutcome pace = run_plant(
        plant, port, {options.interface, period_s, options.duration_s, stop_on_signals()}, scenario.seed);
    std::cout << "plant: " << port.commands() << " command frames, " << port.timeouts()
              << " times without command, " << port.refused() << " frames refused\n";
    print_pace(std::cout, pace);
    return 0;
}

} // namespace

void add_plant_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<PlantOptions>();
    CLI::App* command =
        app.add_subcommand("plant", "Simulates an arm on a CAN bus: sends sensor readings, receives torques");
    command->add_option("--robot", options->robot, "The arm")->required()->type_name("R.urdf");
    command
        ->add_option("--scenario", options->scenario,
                     "Friction, payloads, sensors, faults and start position: docs/reference/scenario.md")
        ->required()
        ->type_name("S.json");
    command->add_option("--bus", options->bus, "The devices: docs/reference/can.md")
        ->required()
        ->type_name("bus.json");
    command->add_option("--can", options->interface, "Interface of the bus")->required()->type_name("IFACE");
    command->add_option("--duration", options->duration_s, "Seconds; default: until Ctrl-C")
        ->check(positive_number())
        ->type_name("S");
    command->footer("Example:\n  dfdyn plant --robot arm.urdf --scenario s.json --bus bus.json --can vcan0\n"
                    "Exit status: 0 done, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
