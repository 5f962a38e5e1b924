// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace dfdyn::tools {

/// A grid line of an axis, with an optional label.
struct AxisTick {
    double value;
    std::string label; ///< SVG text; empty: a line only
};

/// A linear axis that maps values in [low, high] to the interval between two pixels.
struct LinearAxis {
    double low, high; ///< low < high
    double low_pixel = 0, high_pixel = 1;

    /// Returns the pixel of `value`; values beyond the ends are clamped.
    double pixel(double value) const;
};

/// Returns an axis for the finite ones of `values`, with a margin at both ends; 0 … 1 if there are none.
LinearAxis linear_axis(const std::vector<double>& values, double low_pixel, double high_pixel);

/// Returns the labelled multiples, within the axis, of the smallest 1, 2 or 5 times a power of ten that is at
/// least a tenth of its range: four to eleven.
std::vector<AxisTick> ticks_of(const LinearAxis& axis);

/// A logarithmic axis that maps values in [low, high] to the interval between two pixels.
struct LogAxis {
    double low, high; ///< > 0, low < high
    double low_pixel = 0, high_pixel = 1;

    /// Returns the pixel of `value`; values beyond the ends, and values that are not positive, are clamped.
    double pixel(double value) const;
};

/// Returns an axis for the positive, finite ones of `values`, with ends at 1, 2 or 5 times a power of ten;
/// 0.1 … 1 if there are none.
LogAxis log_axis(const std::vector<double>& values, double low_pixel, double high_pixel);

/// Returns the multiples 1 … 9 of the powers of ten within the axis, with labels at the powers. Axes of less
/// than two decades also have labels at 2 and 5. Axes of more than eight decades have every other power only,
/// without multiples.
std::vector<AxisTick> ticks_of(const LogAxis& axis);

} // namespace dfdyn::tools
