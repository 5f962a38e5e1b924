// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Detects an output whose prediction error is much larger than usual. The prediction of each channel is the
/// last output or the line through the last two, whichever has had the smaller errors. The limit is ten times
/// the usual error, and at least 0.5 % of the largest value so far. A force may change at any rate; so
/// several such outputs in a row that agree with each other are believed; not where they are the very same,
/// as those of a sensor that freezes. O(values).
template <int values>
class JumpGate {
  public:
    using Values = std::array<double, static_cast<std::size_t>(values)>;

    /// Outputs further apart than `max_age` are not compared.
    explicit constexpr JumpGate(std::int64_t max_age_ns) noexcept : max_age_ns_(max_age_ns) {}

    /// Whether this output is to be refused.
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
    static constexpr int enough = 4; ///< that agree
    static constexpr int enough_after_silence = 3;
    static constexpr double usual_times = 10;
    static constexpr double share_of_largest = 0.005;
    static constexpr double implausible = 3; ///< times the usual: more is learned as this; ten would run away

    /// The last outputs of those that follow each other.
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

    /// Whether an output may follow a line. Its plausible distances from the line are learned.
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
            const double limit = usual_times * usual + share_of_largest * largest_[i];
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
    Values usual_change_{}; ///< between outputs that follow each other
    Values usual_bend_{};   ///< from the line through the two before
    Values largest_{};
    int learned_ = 0;
    std::uint64_t jumps_ = 0;
};

} // namespace dfdyn::hal
