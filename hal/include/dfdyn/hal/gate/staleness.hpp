// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::hal {

/// Whether the last value of a source may still stand for an instant after it. A value is never taken for a
/// new one because it is still there.
class StalenessGate {
  public:
    explicit constexpr StalenessGate(std::int64_t max_age_ns) noexcept : max_age_ns_(max_age_ns) {}

    /// Whether a value measured at `stamp_ns` is too old at `instant_ns`. A call that finds it so is counted.
    constexpr bool stale(std::int64_t stamp_ns, std::int64_t instant_ns) noexcept {
        const bool stale = instant_ns - stamp_ns > max_age_ns_;
        stale_ += stale ? 1U : 0U;
        return stale;
    }

    [[nodiscard]] constexpr std::int64_t max_age_ns() const noexcept { return max_age_ns_; }

    /// Number of requests for a stale value.
    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return stale_; }

  private:
    std::int64_t max_age_ns_;
    std::uint64_t stale_ = 0;
};

} // namespace dfdyn::hal
