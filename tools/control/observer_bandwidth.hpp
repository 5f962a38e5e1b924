// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"
#include "tools/simulation/scenario/scenario.hpp"

namespace dfdyn::tools {

/// Returns the velocity filter of a loop: the scenario's, with its window in readings of the loop.
DerivativeModel loop_filter(const Scenario& scenario);

/// Returns the bandwidth of the disturbance observer, rad/s per joint: the largest one up to 40 with a phase
/// margin (dfdyn::LoopMargin) of
/// - 20 degrees at the joint's own inertia at the start of the motion, and at 0.6 and 2 times this inertia;
/// - 10 degrees at the smallest and largest inertia that the joints move together in the first 20 s of the
///   motion. If two joints have nearly parallel axes, their feedbacks turn them against each other, against
///   a fraction of their own inertias.
///
/// The delay is the bus' (`delay_ticks`), plus half a tick for holding the command, plus that of a
/// velocity from half the largest window, a quarter of its duration. Slower motion has longer windows and a
/// smaller margin.
JointVector default_bandwidth(const Robot& robot, const Scenario& scenario, int delay_ticks);

} // namespace dfdyn::tools
