// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// What the model predicts: which columns of a recording are its outputs.
enum class OutputKind {
    joint_torque,  ///< `tau`: tau1..tauN, N·m
    motor_current, ///< `i`: i1..iN, A
    wrench,        ///< `wrench`: fx fy fz (N) mx my mz (N·m)
};

/// `tau`, `i` or `wrench`; throws InputError for anything else.
OutputKind parse_output_kind(std::string_view text);

/// The columns of that kind for an arm of `joint_count` joints.
std::vector<std::string> output_names(OutputKind kind, std::size_t joint_count);

/// `prefix`1..`prefix``count`, as the columns of a recording are named: `joint_names("qd", 6)`.
std::vector<std::string> joint_names(std::string_view prefix, std::size_t count);

/// Rows of a recording, counted from 0 at the first row below the header, bad rows included: the same rows
/// whether or not bad ones are skipped.
struct RowRange {
    std::size_t first = 0;
    std::optional<std::size_t> last = std::nullopt; ///< not included; none: to the end
};

/// `FIRST:LAST`, either may be empty. Throws InputError for anything else, or when no row can be in it.
RowRange parse_row_range(std::string_view text);

/// Columns that belong together, with all their rows.
struct Columns {
    std::vector<std::string> names;
    std::vector<double> values; ///< rows × names.size(), row by row

    /// False: the recording does not have them, or nobody asked for them.
    bool present() const noexcept { return !names.empty(); }
    /// One value per name. `index` < Recording::row_count().
    std::span<const double> row(std::size_t index) const {
        return std::span(values).subspan(index * names.size(), names.size());
    }
};

/// How many rows `skip_bad_rows` left out, by reason; a row counts once, for the first reason met.
struct SkippedRows {
    std::size_t ragged = 0;       ///< more or fewer fields than the header
    std::size_t not_a_number = 0; ///< a field that is needed is empty or no decimal number
    /// nan, infinite, or beyond what a double (a time: int64 nanoseconds) holds
    std::size_t out_of_range = 0;
    std::size_t time_not_increasing = 0; ///< time at or before that of the last row kept

    std::size_t total() const noexcept { return ragged + not_a_number + out_of_range + time_not_increasing; }
};

/// `3 rows skipped: 2 ragged, 1 not a number`; `0 rows skipped` when there are none.
std::string describe(const SkippedRows& skipped);

/// One recording; every vector below has one entry, or row, per sample.
struct Recording {
    std::string source; ///< the file, as the user named it
    std::vector<double> time_s;
    std::vector<std::int64_t> time_ns; ///< time_s rounded to nanoseconds; strictly increasing
    Columns position;                  ///< q1..qN, rad
    Columns velocity;                  ///< qd1..qdN, rad/s; optional
    Columns acceleration;              ///< qdd1..qddN, rad/s²; optional
    Columns output;                    ///< optional
    /// 1 where the row does not follow the one before it without a break: the first row, and the first after
    /// skipped ones. Whoever keeps a window over rows starts it again there.
    std::vector<std::uint8_t> gap_before;
    SkippedRows skipped;
    /// In the file but not read, for a message (by `listed`): `i1`, `column 7 (unnamed)`.
    std::vector<std::string> ignored_columns;

    std::size_t row_count() const noexcept { return time_ns.size(); }
    std::size_t joint_count() const noexcept { return position.names.size(); }
};

struct ReadOptions {
    std::size_t joint_count = 0; ///< joints of the chain; 0: as many as the recording has
    std::optional<OutputKind> outputs = std::nullopt; ///< required when given
    bool velocity = false;                            ///< read them when the recording has them
    bool acceleration = false;                        ///< likewise
    RowRange rows = {};                               ///< rows outside are not looked at
    bool skip_bad_rows = false;                       ///< false: the first bad row is an error
};

/// Reads a CSV recording: a header, then one row per sample, separated by commas. Accepted: LF or CRLF, a
/// byte order mark, no newline at the end, empty lines at the end, spaces around fields, names (not values)
/// in double quotes, a leading plus, columns that nobody asked for (their fields may hold anything but a
/// comma). Locale independent. Throws InputError with file, line and column otherwise: see the tests for each
/// message. Cost: one pass, O(file); memory of the values kept, and 1 MiB.
Recording read_recording(const std::filesystem::path& path, const ReadOptions& options);

/// Reads several in order; `options.rows` applies to each. Throws InputError as above, and when they do not
/// all have the same position, velocity, acceleration and output columns.
std::vector<Recording> read_recordings(std::span<const std::filesystem::path> paths,
                                       const ReadOptions& options);

} // namespace dfdyn::tools
