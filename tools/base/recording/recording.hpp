// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/column_patterns.hpp"
#include "tools/base/recording/units.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Joints of a recording, and so of a model: far more than an arm has.
inline constexpr std::size_t largest_recorded_joint_count = 64;

/// Predicted quantity: the columns of a recording that are the outputs.
enum class OutputKind {
    joint_torque,  ///< `tau`: tau1..tauN, N·m
    motor_current, ///< `i`: i1..iN, A
    wrench,        ///< `wrench`: fx fy fz (N) mx my mz (N·m)
};

/// Reads `tau`, `i` or `wrench`. Throws InputError for any other text.
OutputKind parse_output_kind(std::string_view text);

/// Returns the columns of this kind for an arm with `joint_count` joints.
std::vector<std::string> output_names(OutputKind kind, std::size_t joint_count);

/// Returns `prefix`1..`prefix``count`, the names of a recording's columns: `joint_names("qd", 6)`.
std::vector<std::string> joint_names(std::string_view prefix, std::size_t count);

/// Rows of a recording, counted from 0 at the first row below the header. Bad rows are counted, so that
/// `skip_bad_rows` does not change the range.
struct RowRange {
    std::size_t first = 0;
    std::optional<std::size_t> last = std::nullopt; ///< not included; empty: to the end
    std::size_t step = 1;                           ///< from 1: every step-th row

    bool has(std::size_t row) const {
        return row >= first && (!last || row < *last) && (row - first) % step == 0;
    }
};

/// Reads `FIRST:LAST` or `FIRST:LAST:STEP`; FIRST and LAST may be empty. Throws InputError for any other
/// text, and for an empty range.
RowRange parse_row_range(std::string_view text);

/// A group of columns with all their rows.
struct Columns {
    std::vector<std::string> names;
    std::vector<double> values; ///< rows × names.size(), row by row

    /// Returns false if the recording does not have the columns, or if they were not requested.
    bool present() const noexcept { return !names.empty(); }
    /// Returns one value per name. `index` < Recording::row_count().
    std::span<const double> row(std::size_t index) const {
        return std::span(values).subspan(index * names.size(), names.size());
    }
};

/// Numbers of rows that `skip_bad_rows` left out, by reason. A row counts once, for its first fault.
struct SkippedRows {
    std::size_t ragged = 0;       ///< more or fewer fields than the header
    std::size_t not_a_number = 0; ///< a required field is empty or no decimal number
    /// nan, infinite, or not representable as a double (a time: as int64 nanoseconds)
    std::size_t out_of_range = 0;
    std::size_t time_not_increasing = 0; ///< time not later than the last kept row's

    std::size_t total() const noexcept { return ragged + not_a_number + out_of_range + time_not_increasing; }
};

/// Returns `3 rows skipped: 2 ragged, 1 not a number`, or `0 rows skipped`.
std::string describe(const SkippedRows& skipped);

/// One recording; every vector below has one entry, or row, per sample.
struct Recording {
    std::string source; ///< the file, as named by the user
    std::vector<double> time_s;
    std::vector<std::int64_t> time_ns; ///< time_s rounded to nanoseconds; strictly increasing
    Columns position;                  ///< q1..qN, rad
    Columns velocity;                  ///< qd1..qdN, rad/s; optional
    Columns acceleration;              ///< qdd1..qddN, rad/s²; optional
    Columns output;                    ///< optional
    /// 1 for a row that does not directly follow the previous one: the first row, and the first after skipped
    /// ones. A window over rows must restart there.
    std::vector<std::uint8_t> gap_before;
    SkippedRows skipped;
    /// Columns in the file that were not read, for a message (with `listed`): `i1`, `column 7 (unnamed)`.
    std::vector<std::string> ignored_columns;
    std::vector<std::string> notes; ///< assumptions about the file; one line each

    std::size_t row_count() const noexcept { return time_ns.size(); }
    std::size_t joint_count() const noexcept { return position.names.size(); }
};

/// Returns the number of rows of all recordings.
inline std::size_t total_rows(std::span<const Recording> recordings) noexcept {
    std::size_t total = 0;
    for (const Recording& recording : recordings) {
        total += recording.row_count();
    }
    return total;
}

struct ReadOptions {
    std::size_t joint_count = 0;                      ///< joints of the chain; 0: the number in the recording
    std::optional<OutputKind> outputs = std::nullopt; ///< required if given
    /// Without `outputs`: the first of these kinds that the recording has, or else the first one, is
    /// required.
    std::vector<OutputKind> output_choices = {};
    bool velocity = false;                     ///< read them if the recording has them
    bool acceleration = false;                 ///< read them if the recording has them
    RowRange rows = {};                        ///< other rows are ignored
    bool skip_bad_rows = false;                ///< false: the first bad row is an error
    ColumnPatterns columns = {};               ///< of quantities with other names than t, q1, …
    Units units = {};                          ///< of quantities in other units than s, rad, N·m, A
    std::vector<std::string> joint_names = {}; ///< of the chain; empty: unknown
    std::vector<bool> prismatic = {};          ///< per joint of the chain; empty: unknown
    /// Topics of a ROS 2 bag: joint states, and a wrench if it is the output; empty: the only ones in the
    /// bag.
    std::vector<std::string> topics = {};
};

/// Reads a CSV recording, plain or compressed with gzip; `-` is standard input. It has a header, then one row
/// per sample. Accepted: fields separated by commas, semicolons or tabs, in double quotes, and with spaces
/// around them; comments (lines that begin with `#`; the last one before the first row is the header if that
/// row has only numbers); a decimal comma where no comma separates fields; LF or CRLF, a byte order mark, no
/// newline at the end, empty lines at the end, a leading plus, and further columns with any content. Times
/// are seconds, or ms, µs or ns since 1970 (see likely_time_unit). Independent of the locale. Throws
/// InputError with file, line and column for other content, and for more than 64 joints. Cost: one pass,
/// O(file); memory for the values kept, and 1 MiB.
Recording read_recording(const std::filesystem::path& path, const ReadOptions& options);

/// Reads several recordings in order; `options.rows` applies to each. Throws InputError as above, and if
/// their position, velocity, acceleration and output columns differ. A recording may have no outputs.
std::vector<Recording> read_recordings(std::span<const std::filesystem::path> paths,
                                       const ReadOptions& options);

/// Returns the names of the recordings' files, without folders.
std::vector<std::string> file_names(std::span<const Recording> recordings);

} // namespace dfdyn::tools
