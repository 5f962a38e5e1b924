// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/report.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Vector multiply-adds of this build, as many as the processor takes: what nothing can be faster than. A
/// burst takes some ten microseconds and touches no memory, so that it also tells whether the machine does
/// something else meanwhile.
class MultiplyAddProbe {
  public:
    /// One burst; vectors per nanosecond.
    double run();
    /// The best burst so far.
    double best() const noexcept { return best_; }

  private:
    double best_ = 0;
};

/// What a time reading costs, ns: the median distance of two in a row.
double clock_cost_ns();

/// False: times of this build mean nothing.
bool is_optimised();

/// What belongs to every time: processor, clock, compiler and flags.
struct MachineFacts {
    std::string processor, clock_source, build;
    double clock_cost_ns = 0;
    bool optimised = true;
};

MachineFacts machine_facts();

std::vector<ReportFact> as_report_facts(const MachineFacts& machine);

} // namespace dfdyn::tools
