// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::hal {

/// Decides if the last value of a source is still valid at a later time.
class StalenessGate {
  public:
    explicit constexpr StalenessGate(std::int64_t max_age_ns) noexcept : max_age_ns_(max_age_ns) {}

    /// Returns true if a value measured at `stamp_ns` is too old at `instant_ns`. Counts these calls.
    constexpr bool stale(std::int64_t stamp_ns, std::int64_t instant_ns) noexcept {
        const bool stale = instant_ns - stamp_ns > max_age_ns_;
        stale_ += stale ? 1U : 0U;
        return stale;
    }

    [[nodiscard]] constexpr std::int64_t max_age_ns() const noexcept { return max_age_ns_; }

    /// Returns the number of requests for a stale value.
    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return stale_; }

  private:
    std::int64_t max_age_ns_;
    std::uint64_t stale_ = 0;
};

} // namespace dfdyn::hal
