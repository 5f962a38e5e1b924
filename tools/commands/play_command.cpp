// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/quiet.hpp"
#include "tools/can/log/play.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/stop_signal.hpp"
#include "tools/commands/options/value_checks.hpp"

#include <iostream>
#include <memory>

namespace dfdyn::tools {
namespace {

struct PlayCommandOptions {
    PlayOptions play;
    bool json = false;
};

void print(const PlayOutcome& outcome) {
    std::cout << outcome.sent << " frames sent, " << outcome.refused << " refused; lateness median "
              << outcome.median_lateness_us << " us, worst " << outcome.worst_lateness_us << " us\n";
    if (outcome.error_frames > 0) {
        std::cout << outcome.error_frames << " error frames left out: only a controller can send them\n";
    }
    if (outcome.backward_stamps > 0) {
        std::cout << outcome.backward_stamps << " stamps ran backward: those frames were sent immediately\n";
    }
    if (outcome.stopped) {
        std::cout << "stopped before the end of the log\n";
    }
}

nlohmann::ordered_json json_of(const PlayOutcome& outcome) {
    return {{"schema", "dfdyn.playback/1"},
            {"sent", outcome.sent},
            {"refused", outcome.refused},
            {"error_frames", outcome.error_frames},
            {"backward_stamps", outcome.backward_stamps},
            {"median_lateness_us", outcome.median_lateness_us},
            {"worst_lateness_us", outcome.worst_lateness_us},
            {"stopped", outcome.stopped}};
}

int run(const PlayCommandOptions& options) {
    const JsonOutput output(options.json);
    const PlayOutcome outcome = play(options.play, stop_on_signals());
    if (!outcome.not_real_time.empty()) {
        print_note("note: the timing is that of an ordinary program (" + outcome.not_real_time + ")");
    }
    output.print(json_of(outcome));
    print(outcome);
    return outcome.stopped || outcome.refused > 0 ? 1 : 0;
}

} // namespace

void add_play_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<PlayCommandOptions>();
    CLI::App* command = app.add_subcommand(
        "play", "Sends a recorded candump log on a CAN interface with its original timing");
    command->add_option("--log", options->play.log, "The recording, in the format of candump -L")
        ->required()
        ->type_name("L.log");
    command->add_option("--can", options->play.interface, "Interface to send on")
        ->required()
        ->type_name("IFACE");
    command
        ->add_option("--from", options->play.log_interface,
                     "Interface in the log whose frames are sent, if it contains several")
        ->type_name("IFACE");
    command->add_option("--rate", options->play.rate, "Speed, as a multiple of the log's own")
        ->type_name("X")
        ->check(number_in(0.001, 1000.0))
        ->capture_default_str();
    add_json_option(*command, options->json);
    command->footer("Example:\n  dfdyn play --log run.log --can vcan0\n"
                    "Exit status: 0 done, 1 stopped by Ctrl-C or frames were refused, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
