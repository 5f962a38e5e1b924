// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/reason.hpp"

#include <cstdint>

namespace dfdyn::hal {

/// Condition of a device according to its heartbeat, with a timeout. A timeout of 0 means that no heartbeat
/// is expected. One that arrives nevertheless is valid for `unexpected_lifetime_ns`, so that a single frame
/// of a device that sends no heartbeats does not invalidate its values forever.
class Heartbeat {
  public:
    static constexpr std::int64_t unexpected_lifetime_ns = 3'000'000'000;

    explicit constexpr Heartbeat(std::int64_t timeout_ns) noexcept : timeout_ns_(timeout_ns) {}

    constexpr void heard(std::int64_t stamp_ns, Reason condition) noexcept {
        heard_ = true;
        stamp_ns_ = stamp_ns;
        condition_ = condition;
    }

    /// Returns the reason for a value measured at `stamp_ns`.
    [[nodiscard]] constexpr Reason reason(std::int64_t stamp_ns) const noexcept {
        const std::int64_t age_ns = stamp_ns - stamp_ns_;
        if (!expected()) {
            return age_ns > unexpected_lifetime_ns ? Reason::ok : condition_;
        }
        return !heard_ || age_ns > timeout_ns_ ? Reason::heartbeat_missing : condition_;
    }

    [[nodiscard]] constexpr bool expected() const noexcept { return timeout_ns_ > 0; }

  private:
    std::int64_t timeout_ns_;
    std::int64_t stamp_ns_ = 0;
    Reason condition_ = Reason::ok;
    bool heard_ = false;
};

} // namespace dfdyn::hal
