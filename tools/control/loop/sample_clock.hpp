// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace dfdyn::tools {

/// Assigns stamped samples to the ticks of a loop. The first sample determines the phase. After it one sample
/// per tick is expected, and the tick count decides:
/// - A sample with the stamp of the expected tick is used.
/// - A sample with an older stamp is used as a measurement of its own, earlier time. Its age is limited to
///   `max_age` and to the number of ticks without a sample since the previous one. Following samples with the
///   same or a decreasing age are used in the same way.
/// - A sample with a later stamp, by at most `max_age`, belongs to a future tick, and a late tick finds it.
/// - Any other stamp contradicts the count, and the sample is not used. After `adopt_after` successive
///   samples with the same contradiction, the clock has jumped, and their stamps become the expected ones.
///   A later stamp in a late tick is no contradiction.
///
/// Stamps within 0.6 of a period of the last assigned one count as the same tick (hysteresis against jitter).
class SampleClock {
  public:
    static constexpr int max_age = 10;    ///< ticks
    static constexpr int adopt_after = 3; ///< samples

    explicit SampleClock(std::int64_t period_ns) noexcept : period_ns_(period_ns) {}

    /// Begins the next tick.
    void advance() noexcept {
        ++tick_;
        silent_ += silent_ <= max_age ? 1 : 0;
    }

    /// Returns the number of ticks from the expected time to the sample's (0: expected, negative: older,
    /// positive: of a future tick), or nothing for an invalid stamp. Call at most once per tick. O(1).
    /// `late`: this tick began after its deadline.
    std::optional<int> place(std::int64_t stamp_ns, bool late = false) noexcept;

    /// Expected measurement time of this tick's sample, on the clock of the stamps; undefined before the
    /// first sample.
    std::int64_t expected_ns() const noexcept { return base_ns_ + tick_ * period_ns_; }

  private:
    int ticks_from_expected(std::int64_t stamp_ns) const noexcept;
    bool follows(int lateness) const noexcept;
    std::optional<int> contradiction(std::int64_t stamp_ns, int lateness) noexcept;

    std::int64_t period_ns_;
    std::int64_t tick_ = 0;
    std::int64_t base_ns_ = 0; ///< expected stamp of tick 0
    bool started_ = false;
    int lateness_ = 0;  ///< of the last sample that was used; not positive
    int silent_ = 0;    ///< ticks without a sample since that one; not counted beyond `max_age`
    int candidate_ = 0; ///< lateness of the last `run_` contradicting samples
    int run_ = 0;
};

} // namespace dfdyn::tools
