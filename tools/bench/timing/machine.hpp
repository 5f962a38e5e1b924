// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/report.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Measures the rate of vector multiply-adds in this build, an upper bound of the processor's speed. A burst
/// takes about ten microseconds without memory access, so that it also detects disturbances by other
/// programs.
class MultiplyAddProbe {
  public:
    /// Runs one burst; returns vectors per nanosecond.
    double run();
    /// Rate of the best burst so far.
    double best() const noexcept { return best_; }

  private:
    double best_ = 0;
};

/// Returns the cost of a clock reading (ns): the median difference of two successive readings.
double clock_cost_ns();

/// Returns false if times of this build are not meaningful.
bool is_optimised();

/// Facts that must accompany every time: processor, clock, compiler and flags.
struct MachineFacts {
    std::string processor, clock_source, build;
    double clock_cost_ns = 0;
    bool optimised = true;
};

MachineFacts machine_facts();

std::vector<ReportFact> as_report_facts(const MachineFacts& machine);

} // namespace dfdyn::tools
