// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/bus/loop_port.hpp"
#include "tools/control/closed_loop.hpp"
#include "tools/control/loop/control_loop.hpp"
#include "tools/control/real_time_run.hpp"
#include "tools/control/report/loop_peaks.hpp"

#include <nlohmann/json_fwd.hpp>

#include <ostream>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Prints the result of a loop, the reason for its stop, and the figures of its learning: one or two lines,
/// and one per reaction to a finding.
void print_loop(std::ostream& out, const ControlLoop& loop);

/// Prints the traffic of the bus and its errors: one line.
void print_port(std::ostream& out, const PortCounters& counters);

/// Prints the times from simulated pushes to the reactions.
void print_reactions(std::ostream& out, const std::vector<PushReaction>& reactions);

/// Returns the figures of print_reactions.
nlohmann::ordered_json reactions_json(const std::vector<PushReaction>& reactions);

/// Returns the figures of print_loop and print_peaks of the run `name`. Joints count from 1; null: no joint.
nlohmann::ordered_json loop_json(const std::string& name, const ControlLoop& loop, const LoopPeaks& peaks);

/// Returns the figures of print_port.
nlohmann::ordered_json port_json(const PortCounters& counters);

/// Returns the figures of print_pace, times in seconds.
nlohmann::ordered_json pace_json(const PaceOutcome& pace);

/// Prints the timing statistics: one line, after a line with the reason if scheduling was not real-time.
void print_pace(std::ostream& out, const PaceOutcome& pace);

} // namespace dfdyn::tools
