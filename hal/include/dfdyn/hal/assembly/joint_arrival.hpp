// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/gate/backlog.hpp"
#include "dfdyn/hal/gate/send_rate.hpp"
#include "dfdyn/hal/reason.hpp"

#include <cstdint>

namespace dfdyn::hal {

/// Judges the values of a joint by the times of their arrival alone: whether they were read in time
/// (BacklogGate) and come from one sender (SendRateGate). A frame may wait for the bus for a whole period,
/// and the SYNC that it answers may be irregular by a period. The timer of a drive may be an RC oscillator.
/// O(1).
class JointArrival {
  public:
    /// `period_ns`: of the values; 0: unknown, so that every value is accepted.
    explicit constexpr JointArrival(std::int64_t period_ns) noexcept
        : backlog_(period_ns), rate_({period_ns, period_ns, clock_tolerance}), known_(period_ns > 0) {}

    /// Takes a stamp, later than the one before. Returns ok, frame_waited or id_collision.
    constexpr Reason take(std::int64_t stamp_ns) noexcept {
        if (!known_) {
            return Reason::ok;
        }
        if (backlog_.waited(stamp_ns)) {
            return Reason::frame_waited;
        }
        return collision_.seen(rate_.too_soon(stamp_ns)) ? Reason::id_collision : Reason::ok;
    }

    /// Returns how many times a second sender was detected.
    [[nodiscard]] constexpr std::uint64_t collisions() const noexcept { return collision_.count(); }

  private:
    static constexpr std::int64_t clock_tolerance = 40;

    BacklogGate backlog_;
    SendRateGate rate_;
    CollisionHold collision_;
    bool known_;
};

} // namespace dfdyn::hal
