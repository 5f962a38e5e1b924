// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Meaning of the fields of a row.
struct Header {
    char separator = ',';
    std::vector<std::string> columns; ///< every column of the file, in order
    std::vector<std::optional<std::size_t>>
        slot;                   ///< per column: its place among the values read; empty if ignored
    std::vector<double> factor; ///< per value read: from the file's unit to the recording's; time: 1
    /// Names of the values read, in the order of their places. The time is at place 0.
    std::vector<std::string> position, velocity, acceleration, output;

    std::size_t value_count() const noexcept {
        return 1 + position.size() + velocity.size() + acceleration.size() + output.size();
    }
    /// Returns the columns without a place, for a message.
    std::vector<std::string> ignored_columns() const;
    /// Returns the name of the column of the time in the file.
    const std::string& time_column() const;
};

/// Throws InputError, starting with `where`, for more joints than a model can have.
void require_joint_count(std::size_t joint_count, const std::string& where);

/// Reads the line of a recording with the names of its columns. Throws InputError, starting with `where`
/// (file and line), for a line that is no header, a repeated name, a missing column of `options`, patterns
/// and units that do not fit, or too many joints.
Header parse_header(std::string_view line, const std::string& where, ReadOptions options);

} // namespace dfdyn::tools
