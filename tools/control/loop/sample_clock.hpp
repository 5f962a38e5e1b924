// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace dfdyn::tools {

/// Places stamped samples on the grid of a loop's ticks. The first sample fixes the phase; from then on one
/// sample is expected per tick, and the tick count decides, not the stamps:
/// - The stamp of the expected tick: the sample is used.
/// - An older stamp, by at most as many ticks as brought no sample since the last one, and by at most
///   `max_age`: the sample is used as a measurement of its own, earlier instant. So are the samples that
///   follow with the same age, and those with which the age falls again.
/// - A later stamp, by at most `max_age`: the sample of a tick to come, which a late tick finds.
/// - Any other stamp contradicts the count: the sample is not used. After `adopt_after` samples in a row
///   with the same contradiction the clock has jumped: from then on theirs are the expected stamps.
/// Stamps within 0.6 of a period of the last placed one count as the same tick (hysteresis against jitter).
class SampleClock {
  public:
    static constexpr int max_age = 10;    ///< ticks
    static constexpr int adopt_after = 3; ///< samples

    explicit SampleClock(std::int64_t period_ns) noexcept : period_ns_(period_ns) {}

    /// The next tick begins.
    void advance() noexcept {
        ++tick_;
        ++silent_;
    }

    /// Ticks from the expected instant to the sample's (0: expected, negative: older, positive: of a tick
    /// to come), or nothing for a stamp that is not believed. Call at most once per tick. O(1).
    std::optional<int> place(std::int64_t stamp_ns) noexcept;

    /// Instant at which the sample of this tick should have been measured, on the clock of the stamps; of
    /// no meaning before the first sample.
    std::int64_t expected_ns() const noexcept { return base_ns_ + tick_ * period_ns_; }

  private:
    int ticks_from_expected(std::int64_t stamp_ns) const noexcept;
    bool follows(int lateness) const noexcept;
    std::optional<int> contradiction(std::int64_t stamp_ns, int lateness) noexcept;

    std::int64_t period_ns_;
    std::int64_t tick_ = 0;
    std::int64_t base_ns_ = 0; ///< expected stamp of tick 0
    bool started_ = false;
    int lateness_ = 0;  ///< of the last sample that was used; at most 0
    int silent_ = 0;    ///< ticks without any sample since that one
    int candidate_ = 0; ///< lateness of the last `run_` samples, which contradict
    int run_ = 0;
};

} // namespace dfdyn::tools
