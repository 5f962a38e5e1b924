// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/system/byte_source.hpp"
#include "tools/base/text/error.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Reads a text file, pipe or device, plain or compressed with gzip, line by line with bounded memory. Lines
/// end with LF or CRLF; the last line may have no line end. A UTF-8 byte order mark at the start is removed.
/// A line may contain any bytes except LF.
class LineReader {
  public:
    static constexpr std::size_t longest_line = std::size_t{1} << 20U; ///< bytes

    /// Opens `path`; `-` is standard input. Throws InputError with the system's reason if it cannot be
    /// opened.
    explicit LineReader(const std::filesystem::path& path);

    /// Returns the next line without its end, or nothing at the end of the file. Valid until the next call.
    /// Throws InputError if the system cannot read (a directory, for example), for damaged compressed
    /// content, or if a line is longer than `longest_line`.
    std::optional<std::string_view> next();

    /// Number of the last line returned by `next`, from 1; 0 before the first.
    std::size_t line_number() const noexcept { return line_number_; }

    /// Returns whether the last line returned by `next` has a line end. Only the last line of a file can lack
    /// it.
    bool terminated() const noexcept { return terminated_; }

  private:
    bool fill();
    InputError too_long(std::size_t line_number, std::string_view begin) const;
    std::string_view take(std::size_t length, std::size_t terminator);

    std::string name_; ///< for messages
    ByteSource source_;
    std::vector<char> buffer_;
    std::size_t begin_ = 0; ///< unread bytes are buffer_[begin_, end_)
    std::size_t end_ = 0;
    std::size_t line_number_ = 0;
    bool terminated_ = true;
};

} // namespace dfdyn::tools
