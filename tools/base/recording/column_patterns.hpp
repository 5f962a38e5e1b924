// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Columns of a recording that has other names than `t`, `q1`, `tau1`, …: a pattern for each quantity `t`,
/// `q`, `qd`, `qdd`, `tau`, `i` and `wrench`. A pattern is
///   - a name with one `*`, which stands for the joint: its number, or its name in the robot's description;
///     for `wrench`, for `fx` to `mz`;
///   - or the names in the order of the joints (for `wrench`, of fx fy fz mx my mz), separated by `|`.
using ColumnPatterns = std::map<std::string, std::string>;

/// Reads `q=PATTERN,tau=PATTERN`; empty text: no pattern. Throws InputError for any other text.
ColumnPatterns parse_column_patterns(std::string_view text);

/// Returns the name that a column has for the program (`t`, `q1`, `fx`), per column of the header. A column
/// keeps its own name if its quantity has no pattern. All other columns that no pattern matches have an empty
/// name. Without a pattern for `t` and a column `t`, the time is the first of `time`, `stamp` and `timestamp`
/// that the header has.
///
/// Joints are in the order of `joint_names` if the columns have these names; otherwise in the order of their
/// consecutive numbers. With empty `joint_names`, columns without numbers keep the order of the header.
/// Throws InputError, starting with `where`, if a pattern matches no column, the joints are ambiguous or
/// incomplete, or a column has two quantities.
std::vector<std::string> column_roles(std::span<const std::string> columns, const ColumnPatterns& patterns,
                                      std::span<const std::string> joint_names, const std::string& where);

} // namespace dfdyn::tools
