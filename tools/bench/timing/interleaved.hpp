// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/timing/machine.hpp"
#include "tools/bench/timing/tick_times.hpp"

#include <functional>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// A subject whose ticks are timed.
class Ticking {
  public:
    virtual ~Ticking() = default;
    virtual void tick() = 0;
};

struct RepetitionOptions {
    int passes = 60;              ///< number of passes over all subjects
    double repetition_us = 400;   ///< duration of one subject's repetition before the next subject follows
    std::size_t fewest_ticks = 4; ///< minimum per repetition
    double undisturbed = 0.97;    ///< minimum probe rate for a valid repetition, relative to the best one
};

/// Measures the ticks of all `subjects` with one repetition of each in turn, so that disturbances of the
/// machine affect all equally. The probe runs before and after each repetition. A repetition is valid if the
/// system did not interrupt the thread and both probes are near the best rate: the core was then free and at
/// its full clock. If less than a tenth is valid, all repetitions are used. `clock_cost_ns` is subtracted
/// from every tick. `on_pass` receives the number of completed passes.
std::vector<TickTimes> time_interleaved(std::span<Ticking* const> subjects, const RepetitionOptions& options,
                                        MultiplyAddProbe& probe, double clock_cost_ns,
                                        const std::function<void(int)>& on_pass);

/// The measurements of one repetition.
struct Repetition {
    double probe_rate; ///< the lower rate of the probes before and after
    bool interrupted;  ///< the system ran another thread on the core
    std::vector<double> times_us;
};

/// Summarizes the valid repetitions, for the best rate of the probe.
TickTimes summarise_undisturbed(const std::vector<Repetition>& repetitions, double best_rate,
                                double undisturbed);

} // namespace dfdyn::tools
