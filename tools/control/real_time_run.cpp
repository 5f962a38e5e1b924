// SPDX-License-Identifier: Apache-2.0
#include "tools/control/real_time_run.hpp"

#include "dfdyn/hal/socketcan_bus.hpp"
#include "tools/base/system/real_time.hpp"
#include "tools/base/text/error.hpp"
#include "tools/control/bus/lossy_bus.hpp"

#include <cmath>
#include <iostream>
#include <limits>
#include <optional>

namespace dfdyn::tools {

namespace {

/// Calls `tick(bus, due_ns, missed, over)` once per period, at absolute times, until it returns false;
/// `over`: whether the run must end.
template <class Tick>
PaceOutcome keep_pace(const RealTimeRun& run, const Tick& tick) try {
    hal::SocketCanBus bus({.interface = run.interface});
    PaceOutcome outcome;
    outcome.not_real_time = become_real_time();
    const std::int64_t start_ns = bus.now_ns();
    const std::int64_t end_ns = run.duration_s > 0 ? start_ns + std::llround(run.duration_s * 1e9)
                                                   : std::numeric_limits<std::int64_t>::max();
    Pace pace(start_ns, std::llround(run.period_s * 1e9));
    for (bool go_on = true; go_on;) {
        while (bus.now_ns() < pace.due_ns()) { // a signal ends a sleep early
            sleep_until(pace.due_ns());
        }
        const bool missed = pace.begin(bus.now_ns());
        go_on = tick(bus, pace.due_ns(), missed, run.stop || pace.due_ns() >= end_ns);
        pace.end(bus.now_ns());
    }
    outcome.counters = pace.counters();
    return outcome;
} catch (const hal::BusError& error) {
    throw InputError(error.what());
}

/// Returns whether the limits of contacts have been measured.
bool contacts_calibrated(const ControlLoop& loop) {
    const LearnedFeedForward* const learned = loop.feed_forward().learned();
    return learned != nullptr && learned->contact_calibration() != nullptr &&
           learned->contact_calibration()->finished();
}

} // namespace

PaceOutcome run_loop(ControlLoop& loop, LoopPort& port, const RealTimeRun& run, LoopLog& log) {
    bool brakes = false;     // requested
    bool calibrated = false; // the limits of contacts
    return keep_pace(run, [&](hal::SocketCanBus& bus, std::int64_t due_ns, bool missed, bool over) {
        port.receive(bus, due_ns);
        LoopInput input = port.sense(bus.now_ns());
        input.deadline_missed = missed;
        input.stop_requested = over;
        loop.enable_learned(run.learned_off == nullptr || !*run.learned_off);
        const JointVector& torque = loop.tick(input);
        if (loop.state() == LoopState::running) {
            log.tracking.add(run.period_s * static_cast<double>(loop.counters().running - 1), loop.error(),
                             loop.feed_forward().learned_share());
            log.recording.add(input);
        }
        if (loop.state() != LoopState::waiting) {
            log.peaks.add(torque);
            port.send(bus, torque);
        }
        if (loop.brake_requested() && !brakes) {
            brakes = true;
            std::cerr << "loop: stopped (" << name(loop.cause())
                      << "): holds the arm, requests its brakes; ends "
                      << (loop.ends_itself() ? "when they have had time to close\n"
                                             : "at Ctrl-C, or after a second without positions\n");
        }
        if (!calibrated && contacts_calibrated(loop)) {
            calibrated = true;
            std::cerr << "loop: contacts: limits measured\n";
        }
        return !loop.done();
    });
}

PaceOutcome run_plant(SimulatedPlant& plant, PlantPort& port, const RealTimeRun& run, std::uint64_t seed) {
    std::optional<std::int64_t> start_ns; // the brakes hold the arm until the first command
    std::optional<LossyBus<hal::SocketCanBus>> devices;
    return keep_pace(run, [&](hal::SocketCanBus& bus, std::int64_t /*due_ns*/, bool /*missed*/, bool over) {
        if (!devices) {
            devices.emplace(bus, seed);
        }
        port.receive(*devices);
        if (port.commands() > 0) {
            start_ns = start_ns.value_or(bus.now_ns());
            // simulates to the present time also in a late tick, so that the stamps of its frames are correct
            plant.advance_to(1e-9 * static_cast<double>(bus.now_ns() - *start_ns));
            devices->set_faults(plant.link_faults());
        }
        plant.apply(port.torque(bus.now_ns()));
        port.send(*devices, plant);
        return !over;
    });
}

} // namespace dfdyn::tools
