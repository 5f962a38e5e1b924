// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Detects gaps in a source's values: consecutive values further apart than the limit.
class GapGate {
  public:
    explicit constexpr GapGate(std::int64_t max_gap_ns) noexcept : max_gap_ns_(max_gap_ns) {}

    /// Returns true if there is a gap between two consecutive stamps.
    [[nodiscard]] constexpr bool between(std::int64_t earlier_ns, std::int64_t later_ns) const noexcept {
        return later_ns - earlier_ns > max_gap_ns_;
    }

    /// Takes a stamp and returns true if a gap precedes it. Counts the gaps. Stamps must increase.
    constexpr bool ends(std::int64_t stamp_ns) noexcept {
        const bool gap = started_ && between(last_ns_, stamp_ns);
        if (gap) {
            ++gaps_;
            longest_ns_ = std::max(longest_ns_, stamp_ns - last_ns_);
        }
        started_ = true;
        last_ns_ = stamp_ns;
        return gap;
    }

    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return gaps_; }
    [[nodiscard]] constexpr std::int64_t longest_ns() const noexcept { return longest_ns_; }

  private:
    std::int64_t max_gap_ns_;
    std::int64_t last_ns_ = 0;
    bool started_ = false;
    std::uint64_t gaps_ = 0;
    std::int64_t longest_ns_ = 0;
};

} // namespace dfdyn::hal
