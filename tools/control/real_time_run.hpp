// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/loop_port.hpp"
#include "tools/control/plant_port.hpp"

#include <atomic>
#include <cstdint>
#include <string>

namespace dfdyn::tools {

/// How well a program kept its time.
struct PaceOutcome {
    std::uint64_t ticks = 0;
    std::uint64_t late = 0; ///< begun after the next tick was due
    std::int64_t worst_lateness_us = 0;
    std::string not_real_time; ///< why the timing is that of an ordinary program; empty: it is not
};

/// Runs `loop` on a CAN interface, a tick per `period_s`, each at an absolute time, until it has stopped; a
/// stop is requested after `duration_s` (0: never) or when `stop` becomes true. A tick that begins late is
/// run at once: a missed deadline. Throws InputError where the interface cannot be opened.
PaceOutcome run_loop(ControlLoop& loop, LoopPort& port, const std::string& interface, double period_s,
                     double duration_s, const std::atomic<bool>& stop);

/// Runs a simulated arm on a CAN interface likewise: it stands until the first command comes, and goes on
/// until `stop` becomes true or `duration_s` is over.
PaceOutcome run_plant(SimulatedPlant& plant, PlantPort& port, const std::string& interface, double period_s,
                      double duration_s, const std::atomic<bool>& stop);

} // namespace dfdyn::tools
