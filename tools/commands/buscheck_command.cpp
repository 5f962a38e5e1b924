// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/replay_bus.hpp"
#include "dfdyn/hal/socketcan_bus.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/can/check/bus_check.hpp"
#include "tools/can/log/candump_log.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/stop_signal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

namespace dfdyn::tools {

namespace {

struct BusCheckOptions {
    std::filesystem::path bus, log;
    std::string interface, log_interface;
    double duration_s = 10;
};

/// Checks all frames of a log, with the log's time stamps.
void check_log(const BusCheckOptions& options, BusCheck& check) {
    CandumpLog log(options.log, options.log_interface);
    hal::ReplayBus bus(log);
    std::array<hal::Frame, 1> room{};
    while (!bus.ended()) {
        bus.advance_to(bus.next_stamp_ns());
        check.take(bus, room);
    }
    log.check();
    warn_of_torn_line(log);
    if (bus.counters().received == 0) {
        throw InputError(shown(options.log) + ": expected frames, found none");
    }
}

void check_interface(const BusCheckOptions& options, BusCheck& check) try {
    hal::SocketCanBus bus({.interface = options.interface});
    const std::atomic<bool>& stop = stop_on_signals();
    std::array<hal::Frame, 64> room{};
    const std::int64_t end_ns = bus.now_ns() + std::llround(options.duration_s * 1e9);
    while (!stop && bus.now_ns() < end_ns) {
        if (!check.take(bus, room)) {
            bus.wait(std::min<std::int64_t>(100'000'000, end_ns - bus.now_ns()));
        }
    }
    constexpr int drains_at_end = 16; // processes frames that wait for later ones
    for (int drain = 0; drain < drains_at_end && check.take(bus, room); ++drain) {
    }
} catch (const hal::BusError& error) {
    throw InputError(error.what());
}

int run(const BusCheckOptions& options) {
    if (options.log.empty() == options.interface.empty()) {
        throw InputError("buscheck: expected one of --can and --log, found " +
                         std::string(options.log.empty() ? "none" : "both"));
    }
    BusCheck check(options.bus.empty() ? std::nullopt : std::optional(read_bus_description(options.bus)));
    options.log.empty() ? check_interface(options, check) : check_log(options, check);
    check.finish();
    const std::vector<BusFinding> findings = bus_findings(check);
    print_bus_check(std::cout, check, findings);
    return findings.empty() ? 0 : 1;
}

} // namespace

void add_buscheck_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<BusCheckOptions>();
    CLI::App* command = app.add_subcommand(
        "buscheck", "Looks at a CAN bus, or a log of one: who sends, how steadily, what is wrong");
    command
        ->add_option("--bus", options->bus,
                     "What should be there: docs/reference/can.md. Without: counts, timing, losses and error "
                     "frames only")
        ->type_name("B.json");
    command->add_option("--can", options->interface, "Look there; nothing is sent")->type_name("IFACE");
    command->add_option("--log", options->log, "Or into a log of candump -L")->type_name("L.log");
    command->add_option("--from", options->log_interface, "The interface in the log, where there are several")
        ->type_name("IFACE");
    command->add_option("--duration", options->duration_s, "With --can: for how long; Ctrl-C ends it before")
        ->check(CLI::Range(0.1, 1e6))
        ->capture_default_str()
        ->type_name("S");
    command->footer("Example:\n  dfdyn buscheck --can can0 --bus bus.json --duration 5\n"
                    "  dfdyn buscheck --log run.log\n"
                    "Exit status: 0 nothing is wrong, 1 there are findings, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
