// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/replay_bus.hpp"
#include "dfdyn/hal/socketcan_bus.hpp"
#include "tools/base/system/atomic_file.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/json_text.hpp"
#include "tools/base/text/text.hpp"
#include "tools/can/check/bus_check.hpp"
#include "tools/can/families/family_catalogue.hpp"
#include "tools/can/log/candump_log.hpp"
#include "tools/can/recognition/recognised_bus.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/commands/options/stop_signal.hpp"
#include "tools/commands/options/value_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

namespace dfdyn::tools {

namespace {

struct BusCheckOptions {
    std::filesystem::path bus, log, draft;
    std::string interface, log_interface;
    double duration_s = 10;
    bool devices = false;
    bool json = false;
};

/// Checks all frames of a log, with the log's time stamps.
void check_log(const BusCheckOptions& options, BusCheck& check, TrafficRecorder& recorder) {
    CandumpLog log(options.log, options.log_interface);
    hal::ReplayBus bus(log);
    RecordedBus recorded(bus, recorder);
    std::array<hal::Frame, 1> room{};
    while (!bus.ended()) {
        bus.advance_to(bus.next_stamp_ns());
        check.take(recorded, room);
    }
    log.check();
    warn_of_torn_line(log);
    if (bus.counters().received == 0) {
        throw InputError(shown(options.log) + ": expected frames, found none");
    }
}

void check_interface(const BusCheckOptions& options, BusCheck& check, TrafficRecorder& recorder) try {
    hal::SocketCanBus bus({.interface = options.interface});
    RecordedBus recorded(bus, recorder);
    const std::atomic<bool>& stop = stop_on_signals();
    std::array<hal::Frame, 64> room{};
    const std::int64_t end_ns = bus.now_ns() + std::llround(options.duration_s * 1e9);
    while (!stop && bus.now_ns() < end_ns) {
        if (!check.take(recorded, room)) {
            bus.wait(std::min<std::int64_t>(100'000'000, end_ns - bus.now_ns()));
        }
    }
    constexpr int drains_at_end = 16; // processes frames that wait for later ones
    for (int drain = 0; drain < drains_at_end && check.take(recorded, room); ++drain) {
    }
} catch (const hal::BusError& error) {
    throw InputError(error.what());
}

void write_draft(const std::filesystem::path& path, const RecognisedBus& recognised) {
    if (path.empty()) {
        return;
    }
    if (!recognised.draft) {
        throw InputError("buscheck: no draft for -o: " + recognised.draft_error);
    }
    write_file(path, json_text(*recognised.draft) + "\n");
    std::cout << "  draft written to " << shown(path) << '\n';
}

/// Returns the figures of both texts. `families`: names; `recognised`: the same with their boards.
nlohmann::ordered_json json_of(const BusCheck& check, const std::vector<BusFinding>& findings,
                               const std::optional<RecognisedBus>& recognised) {
    nlohmann::ordered_json json = bus_check_json(check, findings);
    json["families"] = nlohmann::ordered_json::array();
    if (recognised) {
        json.update(recognised_json(*recognised));
    }
    return json;
}

int run(const BusCheckOptions& options) {
    const JsonOutput output(options.json);
    if (options.devices && !(options.log.empty() && options.interface.empty() && !options.json)) {
        throw InputError("buscheck: expected --devices alone, found --log, --can or --json");
    }
    if (options.devices) {
        std::cout << device_page();
        return 0;
    }
    if (options.log.empty() == options.interface.empty()) {
        throw InputError("buscheck: expected one of --can and --log, found " +
                         std::string(options.log.empty() ? "none" : "both"));
    }
    if (!options.bus.empty() && !options.draft.empty()) {
        throw InputError("buscheck: expected --bus or -o, which writes a draft of it, found both");
    }
    check_outputs({options.draft}, {options.log});
    BusCheck check(options.bus.empty() ? std::nullopt : std::optional(read_bus_description(options.bus)));
    TrafficRecorder recorder;
    options.log.empty() ? check_interface(options, check, recorder) : check_log(options, check, recorder);
    check.finish();
    std::vector<BusFinding> findings = bus_findings(check);
    std::optional<RecognisedBus> recognised;
    if (options.bus.empty()) {
        recognised = recognise_bus(recorder.frames());
        add_findings(*recognised, check, findings);
    }
    output.print(json_of(check, findings, recognised));
    print_bus_check(std::cout, check, findings);
    if (recognised) {
        print_recognised_bus(std::cout, *recognised);
        write_draft(options.draft, *recognised);
    }
    return findings.empty() ? 0 : 1;
}

} // namespace

void add_buscheck_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<BusCheckOptions>();
    CLI::App* command = app.add_subcommand(
        "buscheck", "Checks a CAN bus, or a log of one: senders, their rates and jitter, faults");
    command
        ->add_option("--bus", options->bus,
                     "Expected devices: docs/reference/can.md. Without --bus, families, motors and rates are "
                     "recognised")
        ->type_name("B.json");
    command
        ->add_option(
            "-o,--output", options->draft,
            "Without --bus: writes a draft of the bus description, if the frames contain efforts. Families "
            "without a draft: docs/reference/devices.md")
        ->type_name("B.json");
    command->add_option("--can", options->interface, "Interface to check; nothing is sent")
        ->type_name("IFACE");
    command->add_option("--log", options->log, "Log to check, in the format of candump -L")
        ->type_name("L.log");
    command->add_option("--from", options->log_interface, "Interface in the log, if it contains several")
        ->needs("--log")
        ->type_name("IFACE");
    command
        ->add_option("--duration", options->duration_s,
                     "With --can: seconds to check; Ctrl-C ends the check earlier")
        ->needs("--can")
        ->check(number_in(0.1, 1e6))
        ->capture_default_str()
        ->type_name("S");
    command->add_flag("--devices", options->devices,
                      "Prints the devices of all families as docs/reference/devices.md");
    add_json_option(*command, options->json);
    command->footer("Example:\n  dfdyn buscheck --can can0 --bus bus.json --duration 5\n"
                    "  dfdyn buscheck --log run.log -o bus.json\n"
                    "Exit status: 0 no fault found, 1 there are findings, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
