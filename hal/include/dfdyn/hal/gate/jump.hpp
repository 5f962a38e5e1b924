// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Detects an output whose prediction error is much larger than usual. Each channel is predicted by the last
/// output or by the line through the last two, whichever had the smaller errors. The limit is ten times the
/// usual error and 0.5 % of the largest value so far, and at least a few of the smallest changes, which are
/// the counts of a quiet sensor. A force may change at any rate. So several
/// consecutive outputs that are consistent are accepted, unless they are identical (frozen sensor).
/// O(values).
template <int values>
class JumpGate {
  public:
    using Values = std::array<double, static_cast<std::size_t>(values)>;

    /// Does not compare outputs further apart than `max_age`.
    explicit constexpr JumpGate(std::int64_t max_age_ns) noexcept : max_age_ns_(max_age_ns) {}

    /// Returns true if this output is rejected.
    constexpr bool jumps(const Values& value, std::int64_t stamp_ns) noexcept {
        const bool stale = trusted_.count > 0 && stamp_ns - trusted_.stamp_ns > max_age_ns_;
        const bool leads = !stale && follows(trusted_, value, stamp_ns);
        const bool agrees = follows(candidate_, value, stamp_ns);
        candidate_ = agrees ? candidate_ : Line{};
        extend(candidate_, value, stamp_ns);
        if (learned_ >= first_outputs && !leads &&
            candidate_.count < (stale ? enough_after_silence : enough)) {
            ++jumps_;
            return true;
        }
        if (leads) {
            extend(trusted_, value, stamp_ns);
        } else {
            trusted_ = candidate_;
        }
        learned_ = std::min(learned_ + 1, first_outputs);
        for (std::size_t i = 0; i < value.size(); ++i) {
            largest_[i] = std::max(largest_[i], magnitude(value[i]));
        }
        return false;
    }

    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return jumps_; }

  private:
    static constexpr int first_outputs = 30;
    static constexpr int enough = 4; ///< consistent outputs
    static constexpr int enough_after_silence = 3;
    static constexpr double usual_times = 10;
    static constexpr double share_of_largest = 0.005;
    /// Of the smallest change. A change by one count and back is a bend by two; rounding adds to both.
    static constexpr double counts_of_change = 2.5, counts_of_bend = 3.5;
    static constexpr double implausible = 3; ///< limit of a learned error, in usual errors; ten diverges

    /// The last consistent outputs.
    struct Line {
        Values last{};
        Values slope{}; ///< per ns
        std::int64_t stamp_ns = 0;
        int count = 0;
    };

    static constexpr void extend(Line& line, const Values& value, std::int64_t stamp_ns) noexcept {
        const auto span = static_cast<double>(stamp_ns - line.stamp_ns);
        const bool repeats = line.count > 0 && value == line.last;
        for (std::size_t i = 0; i < value.size() && line.count > 0; ++i) {
            line.slope[i] = (value[i] - line.last[i]) / span;
        }
        line.last = value;
        line.stamp_ns = stamp_ns;
        line.count = std::min(line.count + (repeats ? 0 : 1), enough);
    }

    /// Returns true if an output continues a line, and adapts the usual errors.
    constexpr bool follows(const Line& line, const Values& value, std::int64_t stamp_ns) noexcept {
        constexpr double memory = 64; // outputs
        const std::int64_t age_ns = stamp_ns - line.stamp_ns;
        if (line.count == 0 || age_ns > max_age_ns_ || age_ns <= 0) {
            return false;
        }
        bool near = true;
        for (std::size_t i = 0; i < value.size(); ++i) {
            const double change = magnitude(value[i] - line.last[i]);
            const double bend =
                magnitude(value[i] - line.last[i] - line.slope[i] * static_cast<double>(age_ns));
            const bool straight = line.count > 1 && usual_bend_[i] < usual_change_[i];
            const double usual = straight ? usual_bend_[i] : usual_change_[i];
            smallest_[i] = change > 0 && !(smallest_[i] > 0 && smallest_[i] < change) ? change : smallest_[i];
            const double counts = straight ? counts_of_bend : counts_of_change;
            const double limit =
                std::max(usual_times * usual + share_of_largest * largest_[i], counts * smallest_[i]);
            near = near && (straight ? bend : change) <= limit;
            const double most = learned_ < first_outputs ? change + bend : implausible * usual;
            usual_change_[i] +=
                (std::min(change, std::max(most, usual_change_[i])) - usual_change_[i]) / memory;
            if (line.count > 1) {
                usual_bend_[i] += (std::min(bend, most) - usual_bend_[i]) / memory;
            }
        }
        return near;
    }

    std::int64_t max_age_ns_;
    Line trusted_;
    Line candidate_;
    Values usual_change_{}; ///< between consecutive outputs
    Values usual_bend_{};   ///< distance from the line through the two before
    Values largest_{};
    Values smallest_{}; ///< change that is not 0
    int learned_ = 0;
    std::uint64_t jumps_ = 0;
};

} // namespace dfdyn::hal
