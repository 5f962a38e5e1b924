// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/axis_tick.hpp"

#include <vector>

namespace dfdyn::tools {

/// A logarithmic axis: values in [low, high] stand between two pixels.
struct LogAxis {
    double low, high; ///< > 0, low < high
    double low_pixel = 0, high_pixel = 1;

    /// Where `value` stands; values beyond the ends stand at them, as do those that are not positive.
    double pixel(double value) const;
};

/// An axis that holds the positive, finite ones of `values`, with ends at 1, 2 or 5 times a power of ten; of
/// 0.1 … 1 if there are none.
LogAxis log_axis(const std::vector<double>& values, double low_pixel, double high_pixel);

/// The multiples 1 … 9 of the powers of ten within the axis, those of 1 labelled; those of 2 and 5 too where
/// the axis has less than two decades; where it has more than eight, only every other power, and no
/// multiples.
std::vector<AxisTick> ticks_of(const LogAxis& axis);

} // namespace dfdyn::tools
