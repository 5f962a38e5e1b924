// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Detects a column `t` that is not in seconds, by the median time step and the speed of the fastest joint
/// (99 % quantile). Mistakes: rows at least 2 s apart; rows at least 0.19 s apart while no joint is faster
/// than 0.03 rad/s; rows less than 20 µs apart while a joint is faster than 60 rad/s. Cost: O(rows log rows).
SetupFindings check_clock(const Recording& recording);

/// Detects angles wrapped at half a turn: neighbouring rows that differ by 2 pi (360) within 3 % while the
/// joint moves less than a tenth of a turn before and after. Cost: O(rows).
SetupFindings check_wrapping(const Recording& recording);

/// Detects implausible outputs: more than 1000 A, or whole numbers above 200 (a warning), indicate mA; more
/// than 20,000 N·m indicates mN·m. The 99.9 % quantile of the magnitudes is used. Cost: O(rows).
SetupFindings check_output_unit(const Recording& recording, OutputKind outputs);

/// Detects positions in degrees or thousandths by the joints' limits: a mistake if they exceed them more than
/// five times and are beyond two turns (5 m); a warning for a smaller excess. Without limits or without a
/// robot (null), at least three joints, and at least half of the joints, beyond two turns indicate degrees.
/// Cost: O(rows).
SetupFindings check_position_unit(const Recording& recording, const Robot* robot);

/// Returns the difference between the largest and the smallest value of a column.
double travel(const Columns& columns, std::size_t index);

/// Returns the largest magnitude in a column.
double largest_magnitude(const Columns& columns, std::size_t index);

} // namespace dfdyn::tools
