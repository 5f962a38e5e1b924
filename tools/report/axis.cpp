// SPDX-License-Identifier: Apache-2.0
#include "tools/report/axis.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

constexpr double room = 0.03; ///< of the range, at either end
constexpr double most_steps = 10;

/// `value` is a multiple of `step`, so that rounding errors near zero become zero.
std::string label_of(double value, double step) {
    std::array<char, 32> text{};
    const double clean = std::abs(value) < 1e-6 * step ? 0 : value;
    return {text.data(),
            std::to_chars(text.data(), text.data() + text.size(), clean, std::chars_format::general, 6).ptr};
}

constexpr double nearly = 1e-9; ///< of a decade: tolerance for rounding errors

/// Returns the largest 1, 2 or 5 times a power of ten that is at most `value`.
double rounded_down(double value) {
    const double power = std::pow(10, std::floor(std::log10(value) + nearly));
    const double digit = value / power * (1 + nearly);
    return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

/// Returns the smallest 1, 2 or 5 times a power of ten that is at least `value`.
double rounded_up(double value) {
    const double power = std::pow(10, std::floor(std::log10(value) + nearly));
    const double digit = value / power * (1 - nearly);
    return power * (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10);
}

std::string plain_number(double value) {
    std::array<char, 32> text{};
    return {text.data(),
            std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr};
}

std::string label_of(int digit, int exponent) {
    if (std::abs(exponent) <= 3) {
        return plain_number(digit * std::pow(10, exponent));
    }
    return (digit == 1 ? "10" : std::to_string(digit) + "·10") + "<tspan dy=\"-5\" font-size=\"9\">" +
           std::to_string(exponent) + "</tspan>";
}

} // namespace

double LinearAxis::pixel(double value) const {
    const double place = std::clamp((value - low) / (high - low), 0.0, 1.0);
    return low_pixel + place * (high_pixel - low_pixel);
}

LinearAxis linear_axis(const std::vector<double>& values, double low_pixel, double high_pixel) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const double value : values) {
        if (std::isfinite(value)) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    }
    if (low > high) {
        return {0, 1, low_pixel, high_pixel};
    }
    const double least = 1e-9 * std::max({std::abs(low), std::abs(high), 1e-9});
    const double margin = std::max(room * (high - low), least);
    return {low - margin, high + margin, low_pixel, high_pixel};
}

std::vector<AxisTick> ticks_of(const LinearAxis& axis) {
    const double step = rounded_up((axis.high - axis.low) / most_steps);
    std::vector<AxisTick> ticks;
    const double first = std::ceil(axis.low / step);
    const double last = std::floor(axis.high / step);
    for (double multiple = first; multiple <= last; ++multiple) {
        ticks.push_back({multiple * step, label_of(multiple * step, step)});
    }
    return ticks;
}

double LogAxis::pixel(double value) const {
    const double place = value > low ? std::min(std::log(value / low) / std::log(high / low), 1.0) : 0.0;
    return low_pixel + place * (high_pixel - low_pixel);
}

LogAxis log_axis(const std::vector<double>& values, double low_pixel, double high_pixel) {
    double low = std::numeric_limits<double>::infinity();
    double high = 0;
    for (const double value : values) {
        if (value > 0 && std::isfinite(value)) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    }
    if (high == 0) {
        return {0.1, 1, low_pixel, high_pixel};
    }
    low = rounded_down(low);
    high = rounded_up(high);
    return {low, high > low ? high : 2 * low, low_pixel, high_pixel};
}

std::vector<AxisTick> ticks_of(const LogAxis& axis) {
    const double decades = std::log10(axis.high / axis.low);
    const bool crowded = decades > 8;
    const auto first = static_cast<int>(std::floor(std::log10(axis.low) + nearly));
    const auto last = static_cast<int>(std::floor(std::log10(axis.high) + nearly));
    std::vector<AxisTick> ticks;
    for (int exponent = first; exponent <= last; ++exponent) {
        for (int digit = 1; digit <= 9; ++digit) {
            const double value = digit * std::pow(10, exponent);
            const bool within = value >= axis.low * (1 - nearly) && value <= axis.high * (1 + nearly);
            if (!within || (crowded && (digit > 1 || exponent % 2 != 0))) {
                continue;
            }
            const bool labelled = digit == 1 || (decades < 2 && (digit == 2 || digit == 5));
            ticks.push_back({value, labelled ? label_of(digit, exponent) : ""});
        }
    }
    return ticks;
}

} // namespace dfdyn::tools
