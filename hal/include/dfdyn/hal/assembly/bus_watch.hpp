// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/clock/clock.hpp"
#include "dfdyn/hal/clock/clock_witness.hpp"
#include "dfdyn/hal/gate/bus_health.hpp"
#include "dfdyn/hal/gate/unexpected_frames.hpp"

namespace dfdyn::hal {

/// State of one bus, independent of its devices.
struct BusWatch {
    explicit constexpr BusWatch(const ClockGate::Config& config) noexcept : clock(config) {}

    ClockGate clock;
    ClockWitness witness; ///< selects the frames of that clock
    BusHealth health;
    UnexpectedFrames unknown;    ///< on identifiers of no known device
    UnexpectedFrames rejected;   ///< on known identifiers, but of another form
    std::uint64_t own = 0;       ///< own frames that the socket returns; ignored
    std::uint64_t from_host = 0; ///< from other programs of this host: a simulation, or a replay

    /// Returns `clock_jumped` if a source is missing because the stamps of its bus are rejected. Returns any
    /// other reason unchanged.
    [[nodiscard]] constexpr Reason explain(Reason reason) const noexcept {
        const bool missing = reason == Reason::position_stale || reason == Reason::output_stale ||
                             reason == Reason::waiting_for_position || reason == Reason::waiting_for_output ||
                             reason == Reason::position_missing || reason == Reason::output_missing;
        return missing && clock.doubtful() ? Reason::clock_jumped : reason;
    }
};

} // namespace dfdyn::hal
