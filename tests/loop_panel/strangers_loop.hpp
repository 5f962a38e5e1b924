// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/description/bus_description.hpp"
#include "tools/robot/robot.hpp"
#include "tools/simulation/scenario/scenario.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace dfdyn::tests {

/// An arm with its drives, and an engineer's choice of gains, filters and motion.
struct StrangersLoop {
    tools::Robot robot;
    tools::Scenario scenario;
    std::optional<tools::BusDescription> bus; ///< none: a direct connection
    std::string summary() const;
};

/// Draws a loop that is different for every seed. The engineer is content with feedback and rigid body alone:
/// in the first 12 s they do not stop, and no command changes by more than 5 % of its limit in a tick.
/// Returns nothing if twelve attempts at gains and velocity filter are not enough.
///
/// `gear_hz`: frequency of each link on its gear while the motor is held, of the first joints as far as the
/// simulation has coordinates for them; 0: rigid gears.
std::optional<StrangersLoop> draw_strangers_loop(std::uint64_t seed, double gear_hz = 0);

} // namespace dfdyn::tests
