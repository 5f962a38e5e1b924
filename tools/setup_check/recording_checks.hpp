// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Finds a column `t` that is not in seconds, by the median time step and the speed of the fastest joint (99
/// % quantile). Mistakes: rows 2 s apart or more; rows 0.19 s apart or more while no joint is faster than
/// 0.03 rad/s; rows less than 20 µs apart while a joint is faster than 60 rad/s. Cost: O(rows log rows).
SetupFindings check_clock(const Recording& recording);

/// Finds angles wrapped at half a turn: neighbouring rows that differ by 2 pi (360) to 3 % while the joint
/// moves less than a tenth of a turn before and after. Cost: O(rows).
SetupFindings check_wrapping(const Recording& recording);

/// Finds outputs that have one value in every row while the arm moves by 0.1 rad (m): a mistake where the
/// output's own joint moves that far and other outputs vary; else a warning, for all motors may be off, and
/// an axis of a wrench may have nothing to show. Joints that move nothing with mass do not count (`robot` may
/// be null). Cost: O(rows).
SetupFindings check_dead_outputs(const Recording& recording, OutputKind outputs, const Robot* robot);

/// Finds outputs that no arm has: more than 1000 A, or whole numbers above 200 (a warning), for mA; more than
/// 20,000 N·m for mN·m. The 99.9 % quantile of the magnitudes counts. Cost: O(rows).
SetupFindings check_output_unit(const Recording& recording, OutputKind outputs);

/// Finds positions in degrees or thousandths by the joints' limits: more than five times beyond them and more
/// than two turns (5 m). Less far beyond is a warning. Without limits, or without a robot (null), three
/// joints beyond two turns, and at least half of the joints, are degrees. Cost: O(rows).
SetupFindings check_position_unit(const Recording& recording, const Robot* robot);

/// The difference between the largest and the least value of a column.
double travel(const Columns& columns, std::size_t index);

/// The largest magnitude in a column.
double largest_magnitude(const Columns& columns, std::size_t index);

} // namespace dfdyn::tools
