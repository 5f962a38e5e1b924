// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "dfdyn/hal/reason.hpp"

#include <cstdint>

namespace dfdyn::hal {

/// Decides from the state and the counters of a bus whether its samples are valid. Lost arbitration is
/// normal. An error-passive controller is degraded, but the frames that it receives are valid.
class BusHealth {
  public:
    /// Takes the state and the counters after a drain. Losses are counted from the first call.
    constexpr void update(BusState state, const BusCounters& counters) noexcept {
        const std::uint64_t lost = counters.dropped + counters.controller_overruns;
        if (started_ && lost != lost_) {
            losses_ += lost - lost_;
            loss_pending_ = true;
        }
        started_ = true;
        lost_ = lost;
        state_ = state;
    }

    /// Returns `bus_off` or `interface_down` if no frames are received, and otherwise ok.
    [[nodiscard]] constexpr Reason reason() const noexcept {
        switch (state_) {
        case BusState::off:
            return Reason::bus_off;
        case BusState::interface_down:
            return Reason::interface_down;
        case BusState::active:
        case BusState::warning:
        case BusState::passive:
            break;
        }
        return Reason::ok;
    }

    [[nodiscard]] constexpr bool degraded() const noexcept {
        return state_ == BusState::warning || state_ == BusState::passive;
    }

    /// Returns true if frames were lost since the last call.
    constexpr bool take_loss() noexcept {
        const bool loss = loss_pending_;
        loss_pending_ = false;
        return loss;
    }

    /// Counts a loss that a device reported.
    constexpr void device_lost() noexcept {
        ++losses_;
        loss_pending_ = true;
    }

    /// Returns the number of frames lost since the first update; a loss reported by a device counts as one.
    [[nodiscard]] constexpr std::uint64_t losses() const noexcept { return losses_; }

  private:
    BusState state_ = BusState::active;
    std::uint64_t lost_ = 0;
    std::uint64_t losses_ = 0;
    bool started_ = false;
    bool loss_pending_ = false;
};

} // namespace dfdyn::hal
