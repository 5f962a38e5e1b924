// SPDX-License-Identifier: Apache-2.0
#include "tools/can/description/text_cursor.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <charconv>

namespace dfdyn::tools {

namespace {

bool ends_statement(std::string_view text) {
    return text.starts_with(';') && (text.size() == 1 || text[1] == '\n' || text[1] == '\r');
}

} // namespace

void TextCursor::skip_blanks() { skip(std::min(rest_.find_first_not_of(" \t"), rest_.size())); }

void TextCursor::skip_line() {
    TextCursor quote = *this;
    for (bool quoted = false; !at_end();) {
        const char character = rest_.front();
        if (quoted && rest_.starts_with("\\\"") && !ends_statement(rest_.substr(2))) {
            skip(2);
            continue;
        }
        if (character == '"') {
            quoted = !quoted;
            quote = *this;
        }
        skip(1);
        if (character == '\n' && !quoted) {
            return;
        }
        if (at_end() && quoted) {
            quote.refuse("a text that ends with \"", "the end of the file");
        }
    }
}

bool TextCursor::accept(std::string_view token) {
    skip_blanks();
    if (!rest_.starts_with(token)) {
        return false;
    }
    skip(token.size());
    return true;
}

void TextCursor::expect(std::string_view token) {
    if (!accept(token)) {
        refuse(in_quotes(token));
    }
}

std::string TextCursor::name(const char* what) {
    skip_blanks();
    const auto part = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    };
    const auto end = std::ranges::find_if_not(rest_, part);
    const std::string_view word = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    if (word.empty() || (word.front() >= '0' && word.front() <= '9')) {
        refuse(what);
    }
    skip(word.size());
    return std::string(word);
}

std::uint64_t TextCursor::whole(const std::string& what, std::uint64_t highest) {
    skip_blanks();
    std::uint64_t value = 0;
    const auto [end, fault] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (fault != std::errc() || value > highest) {
        refuse(what + " from 0 to " + std::to_string(highest));
    }
    skip(static_cast<std::size_t>(end - rest_.data()));
    return value;
}

double TextCursor::number(const char* what) {
    skip_blanks();
    const std::string_view word = rest_.substr(0, rest_.find_first_of(",)|]\r\n"));
    const ParsedNumber parsed = parse_number(trimmed(word));
    if (parsed.fault != NumberFault::none) {
        refuse(what);
    }
    skip(word.size());
    return parsed.value;
}

std::string TextCursor::quoted() {
    expect("\"");
    const std::size_t end = rest_.find_first_of("\"\n");
    if (end == std::string_view::npos || rest_[end] != '"') {
        refuse("a text that ends with \" in its line");
    }
    std::string text(rest_.substr(0, end));
    skip(end + 1);
    return text;
}

void TextCursor::refuse(const std::string& expected) const {
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\n"));
    refuse(expected, at_end()        ? "the end of the file"
                     : at_line_end() ? "the end of the line"
                                     : in_quotes(word));
}

void TextCursor::refuse(const std::string& expected, const std::string& found) const {
    throw InputError(source_ + ":" + std::to_string(line_) + ":" + std::to_string(column_) + ": expected " +
                     expected + ", found " + found);
}

void TextCursor::skip(std::size_t count) {
    for (const char character : rest_.substr(0, count)) {
        column_ = character == '\n' ? 1 : column_ + 1;
        line_ += character == '\n' ? 1U : 0U;
    }
    rest_.remove_prefix(count);
}

} // namespace dfdyn::tools
