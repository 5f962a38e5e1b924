// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/system/pace.hpp"
#include "tools/control/bus/loop_port.hpp"
#include "tools/control/bus/plant_port.hpp"
#include "tools/control/report/loop_peaks.hpp"
#include "tools/control/report/loop_recording.hpp"
#include "tools/control/report/tracking.hpp"

#include <atomic>
#include <string>

namespace dfdyn::tools {

/// Interface, period and duration of a run.
struct RealTimeRun {
    std::string interface;
    double period_s = 0.001;
    double duration_s = 0;         ///< 0: until `stop`
    const std::atomic<bool>& stop; ///< becomes true at a signal
    const std::atomic<bool>* learned_off =
        nullptr; ///< of a loop: while it is true, the learned torque is disabled
};

struct PaceOutcome {
    PaceCounters counters;
    std::string not_real_time; ///< reason for missing real-time scheduling; empty: it is active
};

/// Log of a loop's motion.
struct LoopLog {
    Tracking tracking; ///< from measured positions
    LoopRecording recording;
    LoopPeaks peaks{}; ///< of the commands
};

/// Runs `loop` on a CAN interface until it is finished, with one tick per period at absolute times. Requests
/// a stop at the end of the duration or when `stop` becomes true. A loop that has stopped by itself holds the
/// arm until then. Any stop is reported on standard error when the loop requests the brakes. A late tick runs
/// immediately. `log` receives every tick of the motion. Throws InputError if the interface cannot be opened.
PaceOutcome run_loop(ControlLoop& loop, LoopPort& port, const RealTimeRun& run, LoopLog& log);

/// Runs a simulated arm on a CAN interface. The arm is at rest until the first command arrives, and runs
/// until the end of the duration or until `stop` becomes true. Frames are lost according to the scenario's
/// faults, with the random seed `seed`.
PaceOutcome run_plant(SimulatedPlant& plant, PlantPort& port, const RealTimeRun& run, std::uint64_t seed);

} // namespace dfdyn::tools
