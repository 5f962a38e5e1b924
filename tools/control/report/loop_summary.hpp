// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/bus/loop_port.hpp"
#include "tools/control/loop/control_loop.hpp"
#include "tools/control/real_time_run.hpp"

#include <ostream>

namespace dfdyn::tools {

/// Prints what a loop did, why it stopped, and what it learned: one or two lines, and one per reaction to a
/// finding.
void print_loop(std::ostream& out, const ControlLoop& loop);

/// Prints the traffic of the bus and its errors: one line.
void print_port(std::ostream& out, const PortCounters& counters);

/// Prints the timing statistics: one line, after a line with the reason if scheduling was not real-time.
void print_pace(std::ostream& out, const PaceOutcome& pace);

} // namespace dfdyn::tools
