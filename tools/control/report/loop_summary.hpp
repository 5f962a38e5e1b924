// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/bus/loop_port.hpp"
#include "tools/control/loop/control_loop.hpp"
#include "tools/control/real_time_run.hpp"

#include <ostream>

namespace dfdyn::tools {

/// What a loop did, why it stopped, and what it learned: one or two lines, and one per action on a finding.
void print_loop(std::ostream& out, const ControlLoop& loop);

/// What came over the bus, and what was wrong with it: one line.
void print_port(std::ostream& out, const PortCounters& counters);

/// How the time was kept: one line, and before it one that says if nothing kept it.
void print_pace(std::ostream& out, const PaceOutcome& pace);

} // namespace dfdyn::tools
