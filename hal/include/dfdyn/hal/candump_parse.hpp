// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/candump_line.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace dfdyn::hal {

namespace detail {

constexpr bool is_blank(char character) noexcept {
    return character == ' ' || character == '\t' || character == '\r';
}
constexpr bool is_digit(char character) noexcept { return character >= '0' && character <= '9'; }

/// Returns the value of a hexadecimal digit, or 16 for any other character.
constexpr std::uint32_t hex_value(char character) noexcept {
    if (is_digit(character)) {
        return static_cast<std::uint32_t>(character - '0');
    }
    const char lower = static_cast<char>(character | 0x20);
    return lower >= 'a' && lower <= 'f' ? static_cast<std::uint32_t>(lower - 'a' + 10) : 16U;
}

/// Parses one line from left to right. Each step returns true if it found the expected text. The first step
/// that fails stores the error in `result`.
class CandumpParser {
  public:
    constexpr explicit CandumpParser(std::string_view line) noexcept : text_(line) {
        while (!text_.empty() && is_blank(text_.back())) {
            text_.remove_suffix(1);
        }
        skip_blanks();
    }

    constexpr CandumpLine parse() noexcept {
        if (at_end() || peek() == '#') {
            return result_;
        }
        if (peek() == 'D') {
            result_.kind = CandumpLine::Kind::dropped;
            static_cast<void>(drop_note());
        } else {
            result_.kind = CandumpLine::Kind::frame;
            result_.frame.stamp_source = StampSource::log;
            static_cast<void>(stamp() && interface_name() && identifier() && payload() && direction());
        }
        return result_;
    }

  private:
    constexpr bool at_end() const noexcept { return at_ == text_.size(); }
    constexpr char peek() const noexcept { return at_end() ? '\0' : text_[at_]; }
    /// Does not use substr, which may throw.
    constexpr std::string_view rest() const noexcept { return {text_.data() + at_, text_.size() - at_}; }
    constexpr void skip_blanks() noexcept {
        while (is_blank(peek())) {
            ++at_;
        }
    }
    constexpr bool take(char character) noexcept {
        if (at_end() || peek() != character) {
            return false;
        }
        ++at_;
        return true;
    }
    constexpr bool take(std::string_view word) noexcept {
        if (!rest().starts_with(word)) {
            return false;
        }
        at_ += word.size();
        return true;
    }

    /// Returns the text up to the next blank.
    constexpr std::string_view token() const noexcept {
        std::size_t end = at_;
        while (end < text_.size() && !is_blank(text_[end])) {
            ++end;
        }
        return {text_.data() + at_, end - at_};
    }

    constexpr bool malformed(CandumpFault fault, std::size_t at) noexcept {
        at_ = at;
        skip_blanks();
        result_.kind = CandumpLine::Kind::malformed;
        result_.fault = fault;
        result_.column = at_ + 1;
        result_.found = token();
        return false;
    }
    constexpr bool malformed(CandumpFault fault) noexcept { return malformed(fault, at_); }

    /// Reads a decimal number of at most 19 digits and returns its number of digits.
    constexpr std::size_t number(std::uint64_t& value) noexcept {
        const std::size_t start = at_;
        value = 0;
        while (is_digit(peek()) && at_ - start < 19) {
            value = value * 10 + static_cast<std::uint64_t>(peek() - '0');
            ++at_;
        }
        return at_ - start;
    }

    constexpr bool stamp() noexcept {
        if (!take('(')) {
            return malformed(CandumpFault::line_start);
        }
        const std::size_t seconds_at = at_;
        std::uint64_t seconds = 0;
        if (number(seconds) == 0 || seconds > last_stamp_second || !take('.')) {
            return malformed(CandumpFault::stamp_seconds, seconds_at);
        }
        const std::size_t decimals_at = at_;
        std::uint64_t decimals = 0;
        const std::size_t digits = number(decimals);
        if ((digits != 6 && digits != 9) || !take(')')) {
            return malformed(CandumpFault::stamp_decimals, decimals_at);
        }
        result_.frame.stamp_ns =
            static_cast<std::int64_t>(seconds * 1'000'000'000 + decimals * (digits == 6 ? 1000U : 1U));
        return true;
    }

    constexpr bool interface_name() noexcept {
        skip_blanks();
        result_.interface = token();
        if (result_.interface.empty() || result_.interface.size() > 15) {
            return malformed(CandumpFault::interface_name);
        }
        at_ += result_.interface.size();
        skip_blanks();
        return true;
    }

    constexpr bool identifier() noexcept {
        const std::size_t start = at_;
        if (token().find('#') != std::string_view::npos && token().find(':') != std::string_view::npos) {
            return malformed(CandumpFault::can_xl);
        }
        std::uint32_t id = 0;
        while (hex_value(peek()) < 16 && at_ - start < 8) {
            id = id << 4U | hex_value(peek());
            ++at_;
        }
        const std::size_t digits = at_ - start;
        if ((digits != 3 && digits != 8) || !take('#')) {
            return malformed(CandumpFault::identifier, start);
        }
        Frame& frame = result_.frame;
        frame.error = digits == 8 && (id & candump_error_flag) != 0;
        frame.extended = digits == 8 && !frame.error;
        frame.id = frame.error ? id - candump_error_flag : id;
        return frame.id < (1U << (digits == 8 ? 29U : 11U)) ||
               malformed(CandumpFault::identifier_range, start);
    }

    constexpr bool payload() noexcept {
        const bool fd = peek() == '#';
        const bool remote = peek() == 'R' || peek() == 'r';
        if (result_.frame.error && (fd || remote)) {
            return malformed(CandumpFault::error_frame);
        }
        if (fd) {
            return fd_flags() && data();
        }
        return (remote ? remote_length() : data()) && raw_length_code();
    }

    /// Reads the flags of a CAN FD frame. Bit 2 is ignored: it marks CAN FD, which the second # does already.
    constexpr bool fd_flags() noexcept {
        ++at_;
        const std::uint32_t flags = hex_value(peek());
        if (flags > 7) {
            return malformed(CandumpFault::fd_flags);
        }
        ++at_;
        result_.frame.fd = true;
        result_.frame.bit_rate_switch = (flags & 1U) != 0;
        result_.frame.error_state_indicator = (flags & 2U) != 0;
        return true;
    }

    constexpr bool data() noexcept {
        Frame& frame = result_.frame;
        const std::size_t start = at_;
        while (!at_end() && !is_blank(peek()) && peek() != '_') {
            if (frame.length == (frame.fd ? 64 : 8)) {
                return malformed(CandumpFault::data_length);
            }
            if (frame.length > 0) {
                static_cast<void>(take('.'));
            }
            const std::uint32_t high = hex_value(peek());
            const std::uint32_t low = at_ + 1 < text_.size() ? hex_value(text_[at_ + 1]) : 16U;
            if (high > 15 || low > 15) {
                return malformed(CandumpFault::data_byte);
            }
            frame.data[frame.length] = static_cast<std::uint8_t>(high << 4U | low);
            ++frame.length;
            at_ += 2;
        }
        return is_frame_length(frame.length, frame.fd) || malformed(CandumpFault::fd_length, start);
    }

    constexpr bool remote_length() noexcept {
        ++at_;
        result_.frame.remote = true;
        if (at_end() || is_blank(peek()) || peek() == '_') {
            return true;
        }
        const std::uint32_t length = hex_value(peek());
        if (length > 8) {
            return malformed(CandumpFault::remote_length);
        }
        ++at_;
        result_.frame.length = static_cast<std::uint8_t>(length);
        return true;
    }

    /// Reads the raw length code of a classic frame: a code above 8 with 8 bytes of data.
    constexpr bool raw_length_code() noexcept {
        if (peek() != '_') {
            return true;
        }
        const std::uint32_t code = at_ + 1 < text_.size() ? hex_value(text_[at_ + 1]) : 16U;
        if (result_.frame.length != 8 || code < 9 || code > 15) {
            return malformed(CandumpFault::raw_length_code);
        }
        at_ += 2;
        return true;
    }

    constexpr bool direction() noexcept {
        const bool blank = is_blank(peek());
        skip_blanks();
        const std::string_view word = token();
        if (blank && (word == "T" || word == "R")) {
            result_.frame.origin = word == "T" ? Origin::this_host : Origin::remote;
            ++at_;
        }
        return at_end() || malformed(CandumpFault::line_end);
    }

    constexpr bool drop_note() noexcept {
        std::uint64_t total = 0;
        if (!take("DROPCOUNT: dropped ") || number(result_.dropped) == 0 || !take(" CAN frame")) {
            return malformed(CandumpFault::drop_note);
        }
        static_cast<void>(take('s'));
        if (!take(" on '")) {
            return malformed(CandumpFault::drop_note);
        }
        result_.interface = rest().substr(0, rest().find('\''));
        at_ += result_.interface.size();
        const bool whole = take("' socket (total drops ") && number(total) > 0 && take(')') && at_end();
        return whole || malformed(CandumpFault::drop_note);
    }

    std::string_view text_;
    std::size_t at_ = 0;
    CandumpLine result_{};
};

} // namespace detail

/// Parses one line of a candump log, without its line end. Views in the result point into `line`. A line with
/// a syntax error gives `malformed` with the position and the expected text, never a frame.
constexpr CandumpLine parse_candump_line(std::string_view line) noexcept {
    return detail::CandumpParser(line).parse();
}

} // namespace dfdyn::hal
