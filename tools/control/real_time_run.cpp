// SPDX-License-Identifier: Apache-2.0
#include "tools/control/real_time_run.hpp"

#include "dfdyn/hal/socketcan_bus.hpp"
#include "tools/common/error.hpp"
#include "tools/common/real_time.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

hal::SocketCanOptions bus_options(const std::string& interface) {
    hal::SocketCanOptions options;
    options.interface = interface;
    return options;
}

/// Calls `tick(due_ns, late)` once per period, at absolute times, until it returns false.
template <class Tick>
PaceOutcome keep_pace(const hal::SocketCanBus& bus, double period_s, const Tick& tick) {
    PaceOutcome outcome;
    outcome.not_real_time = become_real_time();
    const std::int64_t period_ns = std::llround(period_s * 1e9);
    std::int64_t due_ns = bus.now_ns() + period_ns;
    for (bool go_on = true; go_on; due_ns += period_ns) {
        while (bus.now_ns() < due_ns) { // a signal ends a sleep early
            sleep_until(due_ns);
        }
        const std::int64_t lateness_ns = bus.now_ns() - due_ns;
        const bool late = lateness_ns > period_ns;
        ++outcome.ticks;
        outcome.late += late ? 1 : 0;
        outcome.worst_lateness_us = std::max(outcome.worst_lateness_us, lateness_ns / 1000);
        go_on = tick(due_ns, late);
    }
    return outcome;
}

/// Whether a run of `duration_s` (0: for ever) is over.
class Clock {
  public:
    Clock(std::int64_t start_ns, double duration_s)
        : end_ns_(duration_s > 0 ? start_ns + std::llround(duration_s * 1e9) : 0) {}
    bool over(std::int64_t now_ns) const noexcept { return end_ns_ != 0 && now_ns >= end_ns_; }

  private:
    std::int64_t end_ns_;
};

} // namespace

PaceOutcome run_loop(ControlLoop& loop, LoopPort& port, const std::string& interface, double period_s,
                     double duration_s, const std::atomic<bool>& stop) try {
    hal::SocketCanBus bus(bus_options(interface));
    const Clock clock(bus.now_ns(), duration_s);
    return keep_pace(bus, period_s, [&](std::int64_t due_ns, bool late) {
        port.receive(bus);
        LoopInput input = port.sense(due_ns, bus.now_ns());
        input.deadline_missed = late;
        input.stop_requested = stop || clock.over(due_ns);
        const JointVector& torque = loop.tick(input);
        if (loop.state() != LoopState::waiting) {
            port.send(bus, torque);
        }
        return loop.state() != LoopState::stopped;
    });
} catch (const hal::BusError& error) {
    throw InputError(error.what());
}

PaceOutcome run_plant(SimulatedPlant& plant, PlantPort& port, const std::string& interface, double period_s,
                      double duration_s, const std::atomic<bool>& stop) try {
    hal::SocketCanBus bus(bus_options(interface));
    const Clock clock(bus.now_ns(), duration_s);
    std::uint64_t tick = 0;
    return keep_pace(bus, period_s, [&](std::int64_t due_ns, bool /*late*/) {
        port.receive(bus);
        if (port.commands() > 0) { // until then its brakes hold it
            plant.advance_to(static_cast<double>(++tick) * period_s);
        }
        plant.apply(port.torque(bus.now_ns()));
        port.send(bus, plant);
        return !stop && !clock.over(due_ns);
    });
} catch (const hal::BusError& error) {
    throw InputError(error.what());
}

} // namespace dfdyn::tools
