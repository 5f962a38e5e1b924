// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <ostream>
#include <span>
#include <string>
#include <string_view>

namespace dfdyn::tools {

/// Writes a table that `read_recording`, pandas and PlotJuggler can read: a header, then rows, separated by
/// commas. Numbers are written so that reading restores the same double.
class CsvWriter {
  public:
    /// Writes the header. `out` must outlive the writer. Throws std::logic_error for a name that is empty or
    /// needs quotes.
    CsvWriter(std::ostream& out, std::span<const std::string> columns);

    /// Appends one field to the current row. Values that are not finite become `nan` or `inf`, which pandas
    /// reads and `read_recording` rejects.
    CsvWriter& field(double value);
    /// Appends one field per value.
    CsvWriter& fields(std::span<const double> values);
    /// Appends a name: a text without comma, quote or line end; throws std::logic_error otherwise.
    CsvWriter& name(std::string_view text);

    /// Ends the row. Throws std::logic_error unless it has one field per column.
    void end_row();

  private:
    void append(std::string_view text);

    std::ostream& out_;
    std::size_t column_count_;
    std::size_t field_count_ = 0; ///< in the current row
};

} // namespace dfdyn::tools
