// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/atomic_file.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/json_text.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/commands/options/setup_options.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/identification/identify.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>

namespace dfdyn::tools {

namespace {

struct IdentifyOptions {
    RobotOptions robot;
    RecordingOptions recordings;
    SetupOptions setup;
    std::string outputs;
    bool consistent = false;
    ZeroPhaseWindow window;
    std::filesystem::path parameters;
    bool json = false;
};

std::vector<Recording> read_all(const IdentifyOptions& options, const Robot& robot, OutputKind outputs) {
    ReadOptions columns = columns_for(robot, outputs);
    columns.velocity = true;
    columns.acceleration = true;
    return options.recordings.read_each_once(columns);
}

void print_chain(const Robot& robot) {
    std::cout << "chain " << robot.base << " to " << robot.tip << ":\n";
    for (const RobotJoint& joint : robot.joints) {
        std::cout << "  " << joint.name << (joint.prismatic ? " (slides) " : " (turns) ") << joint.link
                  << ", " << joint.inertia[0] << " kg\n";
    }
    if (robot.sensor) {
        const auto carrier = static_cast<std::ptrdiff_t>(robot.sensor->link);
        double beyond = robot.sensor->inertia_beyond[0];
        std::for_each(robot.joints.begin() + carrier, robot.joints.end(),
                      [&beyond](const RobotJoint& joint) { beyond += joint.inertia[0]; });
        std::cout << "F/T sensor at " << robot.sensor->joint << ", measures "
                  << (robot.sensor->parent_to_child ? "parent to child" : "child to parent") << ", " << beyond
                  << " kg beyond it\n";
    }
}

void print_base_parameters(const Identification& found) {
    const BaseFit& fit = found.fit;
    const auto determined = std::ranges::count(fit.determined, true);
    std::cout << found.base.count() << " base parameters of " << found.base.combination.cols() << "; "
              << found.samples << " samples determine " << determined << " of them (condition "
              << std::setprecision(3) << fit.condition << ")\n"
              << "       value     nominal   deviation  unit   parameter\n";
    for (std::size_t i = 0; i < found.base_names.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        std::cout << (fit.determined[i] ? "  " : "? ") << std::setprecision(4) << std::setw(10)
                  << fit.value[row] << "  " << std::setw(10) << fit.nominal[row] << "  " << std::setw(10)
                  << fit.deviation[row] << "  " << found.base_units[i] << '\t' << found.base_names[i] << '\n';
    }
    std::cout << "? = not determined: the deviation is more than a third of value and nominal value\n";
}

void print_errors(const Identification& found) {
    std::cout << "rms error:  nominal   fitted" << (found.consistent ? "    consistent" : "") << '\n';
    for (std::size_t k = 0; k < found.output_names.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        std::cout << "  " << std::setw(6) << std::left << found.output_names[k] << std::right
                  << std::setprecision(4) << std::setw(11) << found.rms_nominal[row] << std::setw(10)
                  << found.rms_fitted[row];
        if (found.consistent) {
            std::cout << std::setw(12) << found.rms_consistent[row];
        }
        std::cout << '\n';
    }
}

void check_window(const ZeroPhaseWindow& window) {
    if (window.degree > 2 * window.half_width) {
        throw InputError("--half-width: expected more than " + std::to_string(window.degree) +
                         " samples for a polynomial of that degree, found " +
                         std::to_string(2 * window.half_width + 1));
    }
}

int run(const IdentifyOptions& options) {
    check_window(options.window);
    const JsonOutput output(options.json);
    check_outputs({options.parameters}, options.recordings.with({options.robot.urdf}));
    const OutputKind outputs = parse_output_kind(options.outputs);
    const Robot robot = options.robot.read(outputs);
    const std::vector<Recording> recordings = read_all(options, robot, outputs);
    if (!options.setup.accept(recordings, {outputs, &robot})) {
        return 1;
    }
    const RecordedMotion recorded = recorded_motion(recordings, options.window);
    const Identification found =
        identify(robot, outputs, recorded, recordings.front().output.names, options.consistent);
    const nlohmann::ordered_json parameters = identification_json(robot, found);
    if (!options.parameters.empty()) {
        write_file(options.parameters, json_text(parameters) + '\n');
    }
    output.print(parameters);
    print_chain(robot);
    print_base_parameters(found);
    print_errors(found);
    return 0;
}

void add_window_options(CLI::App& command, ZeroPhaseWindow& window) {
    command
        .add_option("--half-width", window.half_width,
                    "Samples before and after each one from which its derivatives are computed, if the "
                    "recording has no qd, qdd")
        ->check(whole_number_in(1, 1000))
        ->capture_default_str();
    command.add_option("--degree", window.degree, "Degree of the polynomial of these derivatives")
        ->check(whole_number_in(2, 8))
        ->capture_default_str();
}

} // namespace

void add_identify_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<IdentifyOptions>();
    CLI::App* command = app.add_subcommand(
        "identify",
        "Fits a robot's inertial parameters to recordings; reports which of them the recordings determine");
    options->robot.add_to(*command, true);
    options->recordings.add_to(*command);
    command->add_option("--outputs", options->outputs, "What was measured: tau (torques), wrench")
        ->required()
        ->check(one_of({"tau", "wrench"}))
        ->type_name("tau|wrench");
    command->add_flag("--consistent", options->consistent,
                      "Also physically consistent parameters: positive masses, inertias of real bodies");
    add_window_options(*command, options->window);
    options->setup.add_to(*command);
    command->add_option("-o,--output", options->parameters, "The parameters")->type_name("P.json");
    add_json_option(*command, options->json);
    command->footer(
        "Example:\n  dfdyn identify --robot arm.urdf --tip tool0 --log run.csv --outputs tau "
        "--consistent -o parameters.json\n"
        "Exit status: 0 done, 1 a mistake in the set-up of a recording (nothing is written), 2 bad "
        "usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
