// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/axis_tick.hpp"

#include <vector>

namespace dfdyn::tools {

/// A linear axis: values in [low, high] stand between two pixels.
struct LinearAxis {
    double low, high; ///< low < high
    double low_pixel = 0, high_pixel = 1;

    /// Where `value` stands; values beyond the ends stand at them.
    double pixel(double value) const;
};

/// An axis that holds the finite ones of `values`, with a little room at both ends; 0 … 1 if there are none.
LinearAxis linear_axis(const std::vector<double>& values, double low_pixel, double high_pixel);

/// Five to ten labelled multiples of 1, 2 or 5 times a power of ten within the axis.
std::vector<AxisTick> ticks_of(const LinearAxis& axis);

} // namespace dfdyn::tools
