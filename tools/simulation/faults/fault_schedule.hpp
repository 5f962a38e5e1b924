// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/faults/fault.hpp"

#include <cstddef>
#include <vector>

namespace dfdyn::tools {

/// Determines the faults of a scenario that are active at a time. Times are compared as whole nanoseconds,
/// because times of steps and ticks are inexact in seconds.
class FaultSchedule {
  public:
    FaultSchedule(std::vector<Fault> faults, std::size_t joints);

    /// Moves to `time_s` (s, since the motion began), forwards or backwards. Returns whether the active
    /// faults differ from those before. Allocates heap memory only in that case. O(1) unless a fault begins
    /// or ends in between.
    bool go_to(double time_s);

    /// Returns the active faults; none before the first `go_to`.
    const Faults& now() const noexcept { return now_; }

  private:
    bool acts(const Fault& fault, std::int64_t time_ns) const noexcept {
        return fault.from_ns <= time_ns && time_ns < fault.until_ns;
    }
    void find_next_change(std::int64_t time_ns);

    std::vector<Fault> faults_;
    Faults now_;
    std::vector<bool> acting_;
    std::int64_t valid_from_ns_ = 0, valid_until_ns_ = 0; ///< validity of `acting_`; initially empty
};

} // namespace dfdyn::tools
