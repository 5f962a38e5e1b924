// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Detects outputs with one value in every row while the arm moves by 0.1 rad (m). A mistake if the output's
/// own joint moves that far and other outputs vary. Otherwise a warning, because all motors may be off, and
/// an axis of a wrench may have no load. Joints that move no mass are ignored (`robot` may be null). Also a
/// mistake: one value for 2 s or more while the joint moves that far. Cost: O(rows).
SetupFindings check_dead_outputs(const Recording& recording, OutputKind outputs, const Robot* robot);

/// Detects outputs that stay at their largest or smallest value, at least three rows in a row and in 10 rows
/// in all, while the arm moves. A mistake if these rows are more than those within the nearest 2 % of the
/// output's range: without a limit, values close to it would be more frequent. Wrenches are not checked.
/// Cost: O(rows).
SetupFindings check_saturated_outputs(const Recording& recording, OutputKind outputs);

/// Detects positions that are multiples of more than 6.5 mrad (mm), which is coarser than ten bits a turn.
/// Cost: O(rows log rows).
SetupFindings check_quantised_positions(const Recording& recording);

/// Detects time stamps that deviate from the instants of the samples by 15 % of a step and more (rms),
/// as rounded ones do. While two joints or more move, the deviation from a smooth course is then the velocity
/// times one common time. Rows 25 ms apart and more are not checked. Cost: O(rows).
SetupFindings check_stamps(const Recording& recording);

} // namespace dfdyn::tools
