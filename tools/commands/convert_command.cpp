// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/error.hpp"
#include "tools/can/log/bus_traffic.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/commands/options/value_checks.hpp"

#include <cmath>
#include <iostream>
#include <memory>

namespace dfdyn::tools {

namespace {

struct ConvertOptions {
    RecordingOptions recordings;
    std::filesystem::path bus;
    std::filesystem::path log;
    TrafficOptions traffic;
    bool json = false;
};

int run(const ConvertOptions& options) {
    const JsonOutput output(options.json);
    const std::vector<std::filesystem::path>& logs = options.recordings.logs;
    if (logs.size() != 1) {
        throw InputError("--log: expected one recording, found " + std::to_string(logs.size()));
    }
    check_outputs({options.log}, options.recordings.with({options.bus}));
    const BusDescription description = read_bus_description(options.bus);
    ReadOptions columns;
    columns.joint_count = static_cast<std::size_t>(description.joint_count);
    columns.outputs = description.outputs;
    const std::vector<Recording> recordings = options.recordings.read(columns);
    const double load = write_bus_log(recordings.front(), description, options.traffic, options.log);
    output.print({{"schema", "dfdyn.conversion/1"}, {"bus_load", load}});
    std::cout << "bus load: " << std::round(1000 * load) / 10 << " %\n";
    return 0;
}

} // namespace

void add_convert_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<ConvertOptions>();
    CLI::App* command = app.add_subcommand(
        "convert", "Writes a CSV recording as the frames that an arm's devices would have sent on a CAN bus");
    options->recordings.add_to(*command);
    command->add_option("--bus", options->bus, "The devices: docs/reference/can.md")
        ->required()
        ->type_name("B.json");
    command->add_option("-o,--output", options->log, "Log in the format of candump -L, with nanoseconds")
        ->required()
        ->type_name("L.log");
    command
        ->add_option("--jitter-us", options->traffic.jitter_us,
                     "Largest delay of a frame; delays are uniformly distributed")
        ->check(number_in(0.0, 1e6))
        ->type_name("US")
        ->capture_default_str();
    command->add_option("--seed", options->traffic.seed, "Seed of the jitter")
        ->check(seed_number())
        ->type_name("N")
        ->capture_default_str();
    add_json_option(*command, options->json);
    command->footer(
        "Example:\n  dfdyn convert --log run.csv --bus bus.json -o run.log\n"
        "The same recording, bus and seed give the same bytes. A bus that cannot carry the frames is "
        "an error.\nExit status: 0 done, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
