// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/line_reader.hpp"

#include "tools/base/text/text.hpp"

#include <algorithm>
#include <cstring>
#include <string>

namespace dfdyn::tools {
namespace {

constexpr std::size_t chunk_size = std::size_t{1} << 16U;
constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

} // namespace

LineReader::LineReader(const std::filesystem::path& path)
    : name_(shown_input(path)), source_(path), buffer_(longest_line + 2 + chunk_size) {}

std::optional<std::string_view> LineReader::next() {
    std::size_t searched = 0;
    while (true) {
        const char* const unread = buffer_.data() + begin_;
        const void* const found = std::memchr(unread + searched, '\n', end_ - begin_ - searched);
        if (found != nullptr) {
            return take(static_cast<std::size_t>(static_cast<const char*>(found) - unread), 1);
        }
        searched = end_ - begin_;
        if (searched > longest_line + 1) {
            throw too_long(line_number_ + 1, {unread, searched});
        }
        if (!fill()) {
            break;
        }
    }
    if (searched == 0) {
        return std::nullopt;
    }
    return take(searched, 0);
}

/// `begin`: the first bytes of the line.
InputError LineReader::too_long(std::size_t line_number, std::string_view begin) const {
    return InputError(
        name_ + ":" + std::to_string(line_number) + ": expected a line of at most " +
        std::to_string(longest_line) + " bytes, found a longer one" +
        (begin.find('\r') < begin.size() - 1 ? " (lines end with CR alone: convert them to LF)" : ""));
}

/// Appends one chunk to the unread bytes. Returns false at the end of the file.
bool LineReader::fill() {
    std::copy(buffer_.data() + begin_, buffer_.data() + end_, buffer_.data());
    end_ -= begin_;
    begin_ = 0;
    const std::size_t count = source_.read(std::span(buffer_).subspan(end_, chunk_size));
    end_ += count;
    return count > 0;
}

/// Returns the first `length` unread bytes as a line, and consumes them and the following `terminator` bytes.
std::string_view LineReader::take(std::size_t length, std::size_t terminator) {
    std::string_view line(buffer_.data() + begin_, length);
    begin_ += length + terminator;
    terminated_ = terminator > 0;
    ++line_number_;
    if (line.ends_with('\r')) {
        line.remove_suffix(1);
    }
    if (line.size() > longest_line) {
        throw too_long(line_number_, line);
    }
    if (line_number_ == 1 && line.starts_with(byte_order_mark)) {
        line.remove_prefix(byte_order_mark.size());
    }
    return line;
}

} // namespace dfdyn::tools
