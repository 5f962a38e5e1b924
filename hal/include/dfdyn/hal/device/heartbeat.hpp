// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/reason.hpp"

#include <cstdint>

namespace dfdyn::hal {

/// What a device says of itself in its heartbeat, and whether it still says it. With a timeout of 0 no
/// heartbeat is expected; one that comes counts all the same.
class Heartbeat {
  public:
    explicit constexpr Heartbeat(std::int64_t timeout_ns) noexcept : timeout_ns_(timeout_ns) {}

    constexpr void heard(std::int64_t stamp_ns, Reason condition) noexcept {
        heard_ = true;
        stamp_ns_ = stamp_ns;
        condition_ = condition;
    }

    /// For a value measured at `stamp_ns`.
    [[nodiscard]] constexpr Reason reason(std::int64_t stamp_ns) const noexcept {
        const bool missing = !heard_ || stamp_ns - stamp_ns_ > timeout_ns_;
        return timeout_ns_ > 0 && missing ? Reason::heartbeat_missing : condition_;
    }

  private:
    std::int64_t timeout_ns_;
    std::int64_t stamp_ns_ = 0;
    Reason condition_ = Reason::ok;
    bool heard_ = false;
};

} // namespace dfdyn::hal
