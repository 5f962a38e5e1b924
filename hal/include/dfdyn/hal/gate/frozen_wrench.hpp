// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Sees a sensor that repeats the very same raw values under fresh stamps. For wrenches, whose last bits are
/// noise; a standing encoder is constant by right.
template <int values>
class FrozenWrenchGate {
  public:
    using Raw = std::array<std::int32_t, static_cast<std::size_t>(values)>;

    /// `limit` identical readings in a row, at least 2, are too many; three over as many periods are, too.
    /// `period_ns`: of the readings; 0: not known.
    explicit constexpr FrozenWrenchGate(int limit, std::int64_t period_ns = 0) noexcept
        : limit_(limit), most_since_frozen_(limit + 2 * (most_others + 1)),
          longest_ns_((limit - 1) * period_ns - period_ns / 2), since_frozen_(most_since_frozen_ + 1) {}

    /// Whether this reading is the limit-th identical one in a row, or a later one. One or two that differ
    /// are believed, but do not end the row: they may have flipped bits. Nor is a sensor believed that shows
    /// the very values at which it was frozen a few readings ago.
    constexpr bool frozen(const Raw& raw, std::int64_t stamp_ns = 0) noexcept {
        since_frozen_ = std::min(since_frozen_ + 1, most_since_frozen_ + 1);
        const bool known = since_frozen_ <= most_since_frozen_ && raw == frozen_;
        const bool repeats = run_ > 0 && raw == last_;
        others_ = repeats ? 0 : others_ + 1;
        if (!repeats && (run_ < 2 || others_ > most_others)) {
            run_ = 1;
            others_ = 0;
            last_ = raw;
            begin_ns_ = stamp_ns;
            return known;
        }
        if (repeats) {
            const bool lasts = longest_ns_ > 0 && run_ >= 2 && stamp_ns - begin_ns_ >= longest_ns_;
            run_ = run_ >= limit_ ? limit_ + 1 : lasts ? limit_ : run_ + 1;
            episodes_ += run_ == limit_ && !known ? 1U : 0U;
        }
        const bool frozen = repeats && run_ >= limit_;
        if (frozen) {
            frozen_ = raw;
            since_frozen_ = 0;
        }
        return frozen || known;
    }

    /// How often the sensor froze.
    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return episodes_; }

  private:
    static constexpr int most_others = 2;

    int limit_;
    int most_since_frozen_;   ///< a row that is frozen still, and twice flipped bits that end it; no longer
    std::int64_t longest_ns_; ///< that identical readings may last; not positive: endless
    std::int64_t begin_ns_ = 0;
    int run_ = 0;    ///< identical readings in a row; it stops one beyond the limit
    int others_ = 0; ///< readings since then that differ
    Raw last_{};
    Raw frozen_{};
    int since_frozen_; ///< readings since the row that had these values
    std::uint64_t episodes_ = 0;
};

} // namespace dfdyn::hal
