// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/gate/bus_health.hpp"
#include "dfdyn/hal/gate/clock.hpp"
#include "dfdyn/hal/gate/offenders.hpp"

namespace dfdyn::hal {

/// What is known of one bus, whatever device is on it.
struct BusWatch {
    explicit constexpr BusWatch(const ClockGate::Config& config) noexcept : clock(config) {}

    ClockGate clock;
    BusHealth health;
    Offenders unknown;     ///< on identifiers that nobody here sends
    Offenders rejected;    ///< on known ones, and not what is sent there
    std::uint64_t own = 0; ///< our own frames come back: not looked at
    std::uint64_t from_host =
        0; ///< from another program of this host: a simulation, or a replay on a live bus
};

} // namespace dfdyn::hal
