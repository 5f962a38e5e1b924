// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/report/axis_tick.hpp"

#include <vector>

namespace dfdyn::tools {

/// A linear axis that maps values in [low, high] to the interval between two pixels.
struct LinearAxis {
    double low, high; ///< low < high
    double low_pixel = 0, high_pixel = 1;

    /// Returns the pixel of `value`; values beyond the ends are clamped.
    double pixel(double value) const;
};

/// Returns an axis for the finite ones of `values`, with a margin at both ends; 0 … 1 if there are none.
LinearAxis linear_axis(const std::vector<double>& values, double low_pixel, double high_pixel);

/// Returns five to ten labelled multiples of 1, 2 or 5 times a power of ten within the axis.
std::vector<AxisTick> ticks_of(const LinearAxis& axis);

} // namespace dfdyn::tools
