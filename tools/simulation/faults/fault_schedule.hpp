// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/faults/fault.hpp"

#include <cstddef>
#include <vector>

namespace dfdyn::tools {

/// Which of a scenario's faults act at a time. Times are compared as whole nanoseconds: those of steps and of
/// ticks are not exact as seconds.
class FaultSchedule {
  public:
    FaultSchedule(std::vector<Fault> faults, std::size_t joints);

    /// Goes to `time_s` (s, since the motion began), earlier or later; returns whether other faults act than
    /// before. No heap unless so. O(1) unless a fault begins or ends in between.
    bool go_to(double time_s);

    /// All that is wrong now; nothing before the first `go_to`.
    const Faults& now() const noexcept { return now_; }

  private:
    bool acts(const Fault& fault, std::int64_t time_ns) const noexcept {
        return fault.from_ns <= time_ns && time_ns < fault.until_ns;
    }
    void find_next_change(std::int64_t time_ns);

    std::vector<Fault> faults_;
    Faults now_;
    std::vector<bool> acting_;
    std::int64_t valid_from_ns_ = 0, valid_until_ns_ = 0; ///< of `acting_`; empty at first
};

} // namespace dfdyn::tools
