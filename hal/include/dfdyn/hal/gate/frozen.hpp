// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/strict_math.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Sees a sensor that repeats the very same raw values under fresh stamps. For wrenches, whose last bits are
/// noise; a standing encoder is constant by right.
template <int values>
class FrozenGate {
  public:
    using Raw = std::array<std::int32_t, static_cast<std::size_t>(values)>;

    /// `limit` identical readings in a row, at least 2, are too many.
    explicit constexpr FrozenGate(int limit) noexcept : limit_(limit) {}

    /// Whether this reading is the limit-th identical one in a row, or a later one. One or two that differ
    /// are believed, but do not end the row: they may have flipped bits.
    constexpr bool frozen(const Raw& raw) noexcept {
        const bool repeats = run_ > 0 && raw == last_;
        others_ = repeats ? 0 : others_ + 1;
        if (!repeats && (run_ < 2 || others_ > most_others)) {
            run_ = 1;
            others_ = 0;
            last_ = raw;
            return false;
        }
        if (repeats) {
            run_ = run_ < limit_ ? run_ + 1 : limit_ + 1;
            episodes_ += run_ == limit_ ? 1U : 0U;
        }
        return repeats && run_ >= limit_;
    }

    /// How often the sensor froze.
    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return episodes_; }

  private:
    static constexpr int most_others = 2;

    int limit_;
    int run_ = 0;    ///< identical readings in a row; it stops one beyond the limit
    int others_ = 0; ///< readings since then that differ
    Raw last_{};
    std::uint64_t episodes_ = 0;
};

} // namespace dfdyn::hal
