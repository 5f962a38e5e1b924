// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/timing/machine.hpp"
#include "tools/bench/timing/tick_times.hpp"

#include <functional>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Something whose ticks are timed.
class Ticking {
  public:
    virtual ~Ticking() = default;
    virtual void tick() = 0;
};

struct RepetitionOptions {
    int passes = 60;              ///< over all that is compared
    double repetition_us = 400;   ///< how long one of them ticks before the next has its turn
    std::size_t fewest_ticks = 4; ///< in a repetition, however long they take
    double undisturbed = 0.97;    ///< of the best probe: below it, a repetition does not count
};

/// Times the ticks of all `subjects`, one repetition of each in turn, so that what else the machine does hits
/// all alike. Before and after each repetition the probe runs; only those between two probes near the best
/// count, because then the core was free and at its full clock, and of these only such during which the
/// system did not give the core to somebody else. If these are fewer than a tenth, all count. `clock_cost_ns`
/// is taken off every tick. `on_pass` is told the number of passes done.
std::vector<TickTimes> time_interleaved(std::span<Ticking* const> subjects, const RepetitionOptions& options,
                                        MultiplyAddProbe& probe, double clock_cost_ns,
                                        const std::function<void(int)>& on_pass);

/// One repetition as it was measured.
struct Repetition {
    double probe_rate; ///< the slower of the two about it
    bool interrupted;  ///< the core went to somebody else meanwhile
    std::vector<double> times_us;
};

/// Of those that count, given the best rate of the probe.
TickTimes summarise_undisturbed(const std::vector<Repetition>& repetitions, double best_rate,
                                double undisturbed);

} // namespace dfdyn::tools
