// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace dfdyn::tools {

/// Reads a text of the DBC syntax token by token and keeps the position for messages. Blanks before a token
/// are skipped. All readers throw InputError `SOURCE:LINE:COLUMN: expected …, found …`.
class TextCursor {
  public:
    TextCursor(std::string_view text, std::string source) : rest_(text), source_(std::move(source)) {}

    bool at_end() const { return rest_.empty(); }
    bool at_line_end() const { return rest_.empty() || rest_.front() == '\n' || rest_.front() == '\r'; }

    void skip_blanks();

    /// Position of the next token.
    TextCursor here() {
        skip_blanks();
        return *this;
    }

    /// Moves to the beginning of the next line. Quoted strings may contain line ends. A quote after a
    /// backslash belongs to the string, unless the statement ends directly after it: a string may also end
    /// with a backslash.
    void skip_line();

    /// Skips `token` if it is the next one; returns whether it was.
    bool accept(std::string_view token);
    void expect(std::string_view token);

    /// Reads a name with the syntax of a C identifier. `what`: its description in messages.
    std::string name(const char* what);
    std::uint64_t whole(const std::string& what, std::uint64_t highest);
    double number(const char* what);
    std::string quoted();

    [[noreturn]] void refuse(const std::string& expected) const;
    [[noreturn]] void refuse(const std::string& expected, const std::string& found) const;

  private:
    void skip(std::size_t count);

    std::string_view rest_;
    std::string source_;
    std::size_t line_ = 1;
    std::size_t column_ = 1;
};

} // namespace dfdyn::tools
