// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/recording/recording.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Mistakes that a recording shows without a robot's model, each only where no arm can have produced it:
/// - `t` in milliseconds, microseconds or nanoseconds (rows 0.19 s apart or more; 50 Hz to 5 kHz assumed), or
///   in something longer than seconds (rows less than 20 µs apart);
/// - angles wrapped at half a turn: two neighbouring rows that differ by 2 pi (360), to 3 %, while the joint
///   moves far less before and after;
/// - an output that has one value in every row.
/// Cost: O(rows).
SetupFindings check_recording(const Recording& recording);

/// Units where no robot gives limits: positions in degrees (the median joint is beyond two turns, and two
/// joints or more are, or a joint moves faster than 60 rad/s), currents in mA (99.9 % quantile above 1000 A,
/// or whole numbers above 200), torques in mN·m (above 20,000 N·m).
SetupFindings check_units(const Recording& recording, OutputKind outputs);

/// A recording of less than 10 s, from which no cause can be named.
SetupFindings check_duration(const Recording& recording);

/// The largest magnitude of column `index`.
double largest_magnitude(const Columns& columns, std::size_t index);

} // namespace dfdyn::tools
