// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/sample_clock.hpp"
#include "dfdyn/core/status.hpp"

#include <cstdint>

namespace dfdyn {

/// Order of the samples' time stamps. Detects lost samples and a sender's clock that has been set back.
class StampSequence {
  public:
    /// Consecutive samples with earlier time stamps after which the sender's clock is assumed to have been
    /// set back. A single such sample is an outlier.
    static constexpr int restart_samples = 3;

    /// Processes the stamp of a sample. `period_ns`: nominal sample period, or 0 if there is none; a step
    /// longer than `gap_ns` then means lost samples. Returns `ok`; `gap` or `clock_restarted` if the sample
    /// begins a new window; `time_not_increasing` if it must be refused. Cost: `SampleClock::cost`.
    Reason accept(std::int64_t time_ns, std::int64_t period_ns, std::int64_t gap_ns) noexcept {
        Reason reason = Reason::ok;
        const bool first = past_samples_ == none;
        if (!first && time_ns <= last_time_ns_) {
            past_samples_ = time_ns < last_time_ns_ ? past_samples_ + 1 : 0;
            if (past_samples_ != restart_samples) {
                return Reason::time_not_increasing;
            }
            clock_.restart();
            reason = Reason::clock_restarted;
        } else if (!first && lost_before(since_last(time_ns), period_ns, gap_ns)) {
            reason = Reason::gap;
        }
        past_samples_ = 0;
        last_time_ns_ = time_ns;
        return reason;
    }

    /// Forgets all stamps.
    void restart() noexcept { *this = {}; }

  private:
    static constexpr int none = -1;

    /// Returns true if samples were lost in a step of that length (ns).
    bool lost_before(std::uint64_t step_ns, std::int64_t period_ns, std::int64_t gap_ns) noexcept {
        return period_ns > 0 ? clock_.lost_before(step_ns, period_ns)
                             : step_ns > static_cast<std::uint64_t>(gap_ns);
    }

    /// Returns the time since the last sample (ns), for a later stamp; the difference of two stamps may need
    /// all 64 bits.
    [[nodiscard]] std::uint64_t since_last(std::int64_t time_ns) const noexcept {
        return static_cast<std::uint64_t>(time_ns) - static_cast<std::uint64_t>(last_time_ns_);
    }

    std::int64_t last_time_ns_ = 0;
    SampleClock clock_;
    int past_samples_ = none; ///< consecutive ones that were refused; `none` before the first sample
};

} // namespace dfdyn
