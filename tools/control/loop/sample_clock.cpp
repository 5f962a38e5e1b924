// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/sample_clock.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

int SampleClock::ticks_from_expected(std::int64_t stamp_ns) const noexcept {
    constexpr double same_tick = 0.6;
    constexpr double farthest = 1e9; // ticks; beyond any relevant jump of a clock
    const double exact = (static_cast<double>(stamp_ns) - static_cast<double>(expected_ns())) /
                         static_cast<double>(period_ns_);
    if (std::abs(exact - lateness_) <= same_tick) {
        return lateness_;
    }
    return static_cast<int>(std::lround(std::clamp(exact, -farthest, farthest)));
}

bool SampleClock::follows(int lateness) const noexcept {
    const bool no_older = lateness >= lateness_;
    // the late sample explains the ticks without a sample
    const bool explained = lateness_ - lateness <= silent_;
    return lateness <= 0 && lateness >= -max_age && (no_older || explained);
}

std::optional<int> SampleClock::contradiction(std::int64_t stamp_ns, int lateness) noexcept {
    run_ = run_ > 0 && lateness == candidate_ ? run_ + 1 : 1;
    candidate_ = lateness;
    if (run_ >= adopt_after) {
        base_ns_ += stamp_ns - expected_ns();
        lateness_ = 0;
        silent_ = 0;
        run_ = 0;
        return 0;
    }
    return lateness > 0 && lateness <= max_age ? std::optional(lateness) : std::nullopt;
}

std::optional<int> SampleClock::place(std::int64_t stamp_ns, bool late) noexcept {
    silent_ = std::max(0, silent_ - 1); // this tick has a sample
    if (!started_) {
        started_ = true;
        base_ns_ = stamp_ns - tick_ * period_ns_;
        silent_ = 0;
        return 0;
    }
    const int lateness = ticks_from_expected(stamp_ns);
    if (late && lateness > 0 && lateness <= max_age) {
        return lateness;
    }
    if (!follows(lateness)) {
        return contradiction(stamp_ns, lateness);
    }
    lateness_ = lateness;
    silent_ = 0;
    run_ = 0;
    return lateness;
}

} // namespace dfdyn::tools
