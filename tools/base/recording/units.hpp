// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Unit of a recording's column.
struct ColumnUnit {
    std::string name;  ///< as in --units
    double factor = 1; ///< to s, rad, m, N·m, N or A
};

/// Units of a recording's columns, where they are not s, rad, m, N·m, N and A: per quantity `t`, `q`, `qd`,
/// `qdd`, `tau`, `i` and `wrench`, one unit for all columns, or one per column.
using Units = std::map<std::string, std::vector<ColumnUnit>>;

/// Reads `t=ns,q=deg,i=mA`; several units of a quantity, one per column, are separated by `|`. `ticks:N` is
/// an encoder with N ticks per turn. Without units for `qd` and `qdd` they have the unit of `q`, per s and
/// s². Throws InputError for any other text.
Units parse_units(std::string_view text);

/// Returns the factor of column `index`, from 0, of `quantity`; 1 if it has no unit. Throws InputError if the
/// quantity has units for a different number of columns than `count`.
double unit_factor(const Units& units, const std::string& quantity, std::size_t index, std::size_t count);

/// Throws InputError for units of positions and their derivatives that joints cannot have: prismatic joints
/// have m or mm, other joints do not have mm, and a chain of both types needs one unit per joint. `rad` and
/// `m` both mean SI units and are accepted for all joints. `prismatic`: per joint; empty: unknown.
void check_units(const Units& units, const std::vector<bool>& prismatic);

/// A time on the recording's clock.
struct TimeValue {
    double seconds = 0;
    std::int64_t nanoseconds = 0;
};

/// Returns the unit (s) of a recording's times from its first time: seconds, or from 1e11, 1e14 and 1e17 on
/// ms, µs and ns since 1970.
double likely_time_unit(double first_time);

/// Returns the time with the value `value` and the text `text`, in units of `unit_s`; exact if the text is a
/// whole number of ns, µs or ms. Empty if the time is not within 9.2e9 s of 0.
std::optional<TimeValue> time_value(double value, std::string_view text, double unit_s);

} // namespace dfdyn::tools
