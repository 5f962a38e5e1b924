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

/// Where, how fast and for how long a program runs.
struct RealTimeRun {
    std::string interface;
    double period_s = 0.001;
    double duration_s = 0;         ///< 0: until `stop`
    const std::atomic<bool>& stop; ///< becomes true at a signal
    const std::atomic<bool>* learned_off =
        nullptr; ///< of a loop: while it is true what is learned is not used
};

struct PaceOutcome {
    PaceCounters counters;
    std::string not_real_time; ///< why the timing is that of an ordinary program; empty: it is not
};

/// What is kept of a loop's motion.
struct LoopLog {
    Tracking tracking; ///< by measured positions
    LoopRecording recording;
    LoopPeaks peaks{}; ///< of the commands
};

/// Runs `loop` on a CAN interface, a tick per period, each at an absolute time, until it is done; a stop is
/// requested when the time is over or `stop` becomes true. A loop that has stopped by itself holds the arm
/// until then, and says so on standard error when it requests the brakes. A tick that begins late is run at
/// once. `log` gets every tick of the motion. Throws InputError where the interface cannot be opened.
PaceOutcome run_loop(ControlLoop& loop, LoopPort& port, const RealTimeRun& run, LoopLog& log);

/// Runs a simulated arm on a CAN interface likewise: it stands until the first command comes, and goes on
/// until the time is over or `stop` becomes true. Frames are lost as the faults of its scenario say, whose
/// seed is `seed`.
PaceOutcome run_plant(SimulatedPlant& plant, PlantPort& port, const RealTimeRun& run, std::uint64_t seed);

} // namespace dfdyn::tools
