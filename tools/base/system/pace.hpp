// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace dfdyn::tools {

/// Timing statistics of a periodic program.
struct PaceCounters {
    std::uint64_t ticks = 0;
    std::uint64_t missed = 0;       ///< ticks that began after the due time of the next one
    std::int64_t worst_late_ns = 0; ///< largest delay from a tick's due time to its start
    std::int64_t longest_ns = 0;    ///< longest tick, from start to end
};

/// Due times of periodic ticks. All are absolute, so that a late tick does not delay later ones. The caller
/// provides the time.
class Pace {
  public:
    Pace(std::int64_t start_ns, std::int64_t period_ns)
        : period_ns_(period_ns), due_ns_(start_ns + period_ns) {}

    std::int64_t due_ns() const noexcept { return due_ns_; }

    /// Begins the due tick. Returns whether it missed its deadline.
    bool begin(std::int64_t now_ns) noexcept {
        const std::int64_t late_ns = now_ns - due_ns_;
        const bool missed = late_ns > period_ns_;
        begun_ns_ = now_ns;
        ++counters_.ticks;
        counters_.missed += missed ? 1 : 0;
        counters_.worst_late_ns = std::max(counters_.worst_late_ns, late_ns);
        return missed;
    }

    /// Ends the tick; the next one becomes due.
    void end(std::int64_t now_ns) noexcept {
        counters_.longest_ns = std::max(counters_.longest_ns, now_ns - begun_ns_);
        due_ns_ += period_ns_;
    }

    const PaceCounters& counters() const noexcept { return counters_; }

  private:
    std::int64_t period_ns_, due_ns_;
    std::int64_t begun_ns_ = 0;
    PaceCounters counters_;
};

} // namespace dfdyn::tools
