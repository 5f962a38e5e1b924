// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Detects a sensor that repeats the same raw values with new stamps. Only for wrenches, whose last bits are
/// noise; the encoder of a joint at rest is constant.
template <int values>
class FrozenWrenchGate {
  public:
    using Raw = std::array<std::int32_t, static_cast<std::size_t>(values)>;

    /// `limit`: identical readings in a row that indicate a fault, at least 2. Three that span as many
    /// periods do, too. `period_ns`: of the readings; 0: unknown.
    explicit constexpr FrozenWrenchGate(int limit, std::int64_t period_ns = 0) noexcept
        : limit_(limit), max_since_frozen_(limit + 2 * (max_different + 1)),
          longest_ns_((limit - 1) * period_ns - period_ns / 2), since_frozen_(max_since_frozen_ + 1) {}

    /// Returns true from the `limit`-th identical reading on. One or two different readings are accepted but
    /// do not end the row, because they may have flipped bits. A reading that shortly afterwards equals the
    /// frozen values is rejected, too.
    constexpr bool frozen(const Raw& raw, std::int64_t stamp_ns = 0) noexcept {
        since_frozen_ = std::min(since_frozen_ + 1, max_since_frozen_ + 1);
        const bool known = since_frozen_ <= max_since_frozen_ && raw == frozen_;
        const bool repeats = run_ > 0 && raw == last_;
        different_ = repeats ? 0 : different_ + 1;
        if (!repeats && (run_ < 2 || different_ > max_different)) {
            run_ = 1;
            different_ = 0;
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

    /// Returns how many times the sensor froze.
    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return episodes_; }

  private:
    static constexpr int max_different = 2;

    int limit_;
    int max_since_frozen_; ///< length of a row that is still frozen, plus two interruptions by flipped bits
    std::int64_t longest_ns_; ///< longest duration of identical readings; not positive: unlimited
    std::int64_t begin_ns_ = 0;
    int run_ = 0;       ///< identical readings in a row; at most one more than the limit
    int different_ = 0; ///< different readings since then
    Raw last_{};
    Raw frozen_{};
    int since_frozen_; ///< readings since the last frozen one
    std::uint64_t episodes_ = 0;
};

} // namespace dfdyn::hal
