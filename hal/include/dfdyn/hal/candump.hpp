// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

// Lines of the logs that `candump -L` and `candump -l` write, one at a time:
//
//     (1700000000.123456) can0 123#DEADBEEF            classic; ID is 3 digits, or 8 for 29 bits
//     (1700000000.123456789) can0 00000123#DE.AD T     nanoseconds, dots, sent by the logging host itself
//     (1700000000.123456) can0 123#R4                  remote request
//     (1700000000.123456) can0 123##1DEADBEEF          CAN FD, with its flags
//     (1700000000.123456) can0 123#0011223344556677_B  raw length code beyond 8
//     (1700000000.123456) can0 20000040#0000000000000000      error frame
//     DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 7)

namespace dfdyn::hal {

/// What was wrong with a line; `expected` says it in words.
enum class CandumpFault : std::uint8_t {
    none,
    line_start,
    stamp_seconds,
    stamp_decimals,
    interface_name,
    identifier,
    identifier_range,
    can_xl,
    fd_flags,
    data_byte,
    data_length,
    fd_length,
    remote_length,
    raw_length_code,
    error_frame,
    line_end,
    drop_note,
};

/// What a line with this fault should have had where it is faulty.
constexpr std::string_view expected(CandumpFault fault) noexcept {
    switch (fault) {
    case CandumpFault::none:
        return "nothing else";
    case CandumpFault::line_start:
        return "(SECONDS.DECIMALS), DROPCOUNT: or a comment with #";
    case CandumpFault::stamp_seconds:
        return "seconds up to 9223372035 and a dot";
    case CandumpFault::stamp_decimals:
        return "6 or 9 decimals and a closing parenthesis";
    case CandumpFault::interface_name:
        return "the name of an interface, at most 15 characters";
    case CandumpFault::identifier:
        return "an identifier of 3 or 8 hexadecimal digits and #";
    case CandumpFault::identifier_range:
        return "an identifier up to 7FF, 1FFFFFFF or, of an error frame, 3FFFFFFF";
    case CandumpFault::can_xl:
        return "classic CAN or CAN FD, not CAN XL";
    case CandumpFault::fd_flags:
        return "flags of CAN FD, 0 to 7";
    case CandumpFault::data_byte:
        return "two hexadecimal digits";
    case CandumpFault::data_length:
        return "at most 8 bytes, or 64 of CAN FD";
    case CandumpFault::fd_length:
        return "0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes";
    case CandumpFault::remote_length:
        return "a length from 0 to 8";
    case CandumpFault::raw_length_code:
        return "a raw length code from 9 to F, after a length of 8";
    case CandumpFault::error_frame:
        return "data of an error frame, which is neither remote nor CAN FD";
    case CandumpFault::line_end:
        return "the end of the line, or R or T";
    case CandumpFault::drop_note:
        return "DROPCOUNT: dropped N CAN frames on 'IFACE' socket (total drops M)";
    }
    return "";
}

/// One line of a candump log, read.
struct CandumpLine {
    enum class Kind : std::uint8_t {
        nothing,  ///< empty, or a comment that starts with #
        frame,    ///< `frame`
        dropped,  ///< `dropped` frames were lost here
        malformed ///< `fault`, at `column`
    };
    Kind kind = Kind::nothing;
    Frame frame{};                 ///< its stamp as in the log, in nanoseconds; `stamp_source` is `log`
    std::string_view interface {}; ///< a view into the line
    std::uint64_t dropped = 0;
    CandumpFault fault = CandumpFault::none;
    std::size_t column = 0;   ///< from 1: where the line stops to make sense
    std::string_view found{}; ///< what stands there, up to the next blank; empty at the end of the line
};

namespace detail {

inline constexpr std::uint32_t candump_error_flag = 0x20000000;
inline constexpr std::int64_t last_stamp_second = 9'223'372'035;

constexpr bool is_blank(char character) noexcept {
    return character == ' ' || character == '\t' || character == '\r';
}
constexpr bool is_digit(char character) noexcept { return character >= '0' && character <= '9'; }

/// The value of a hexadecimal digit, or 16 for anything else.
constexpr std::uint32_t hex_value(char character) noexcept {
    if (is_digit(character)) {
        return static_cast<std::uint32_t>(character - '0');
    }
    const char lower = static_cast<char>(character | 0x20);
    return lower >= 'a' && lower <= 'f' ? static_cast<std::uint32_t>(lower - 'a' + 10) : 16U;
}

/// Reads one line from left to right. Each step returns whether it found what it expects; the first that does
/// not leaves the fault in `result`.
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
        if (!text_.substr(at_).starts_with(word)) {
            return false;
        }
        at_ += word.size();
        return true;
    }

    /// From here to the next blank.
    constexpr std::string_view token() const noexcept {
        std::size_t end = at_;
        while (end < text_.size() && !is_blank(text_[end])) {
            ++end;
        }
        return text_.substr(at_, end - at_);
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

    /// A decimal number of at most 19 digits; returns how many it has.
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

    /// Bit 2 says only that it is CAN FD, which the second # says too.
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

    /// What a controller was sent as length when that was beyond 8; it means 8 bytes.
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
        const std::string_view rest = text_.substr(at_);
        result_.interface = rest.substr(0, rest.find('\''));
        at_ += result_.interface.size();
        const bool whole = take("' socket (total drops ") && number(total) > 0 && take(')') && at_end();
        return whole || malformed(CandumpFault::drop_note);
    }

    std::string_view text_;
    std::size_t at_ = 0;
    CandumpLine result_{};
};

} // namespace detail

/// Reads one line of a candump log, without its end. Views in the result point into `line`. A faulty line
/// gives `malformed` with the place and the reason, never a frame.
constexpr CandumpLine parse_candump_line(std::string_view line) noexcept {
    return detail::CandumpParser(line).parse();
}

/// How finely a log tells time.
enum class StampDecimals : std::uint8_t {
    microseconds = 6, ///< what every tool reads; the nanoseconds are cut off
    nanoseconds = 9   ///< as by `candump -N`; can-utils before 2023 misread it
};

/// Room enough for any line.
using CandumpText = std::array<char, 192>;

namespace detail {

/// Puts characters into a CandumpText, which holds the longest line there can be.
class CandumpWriter {
  public:
    constexpr explicit CandumpWriter(CandumpText& text) noexcept : text_(text) {}

    constexpr void put(char character) noexcept { text_[size_++] = character; }
    constexpr void put(std::string_view word) noexcept {
        for (const char character : word) {
            put(character);
        }
    }
    constexpr void hex(std::uint32_t value, unsigned digits) noexcept {
        for (unsigned digit = digits; digit > 0; --digit) {
            put("0123456789ABCDEF"[value >> 4U * (digit - 1) & 0xFU]);
        }
    }
    constexpr void decimal(std::int64_t value, unsigned digits) noexcept {
        size_ += digits;
        for (unsigned digit = 1; digit <= digits; ++digit) {
            text_[size_ - digit] = static_cast<char>('0' + value % 10);
            value /= 10;
        }
    }
    constexpr std::string_view written() const noexcept { return {text_.data(), size_}; }

  private:
    CandumpText& text_;
    std::size_t size_ = 0;
};

constexpr void write_payload(const Frame& frame, CandumpWriter& out) noexcept {
    if (frame.remote) {
        out.put('R');
        if (frame.length > 0) {
            out.hex(frame.length, 1);
        }
        return;
    }
    if (frame.fd) {
        out.put('#');
        out.hex((frame.bit_rate_switch ? 1U : 0U) | (frame.error_state_indicator ? 2U : 0U), 1);
    }
    for (std::size_t index = 0; index < frame.length; ++index) {
        out.hex(frame.data[index], 2);
    }
}

} // namespace detail

/// Writes `frame` as candump does, without the end of the line, into `text`; a frame of this host with ` T`,
/// others without ` R`. Nothing comes back for what no log can hold: a frame that is not well-formed, a stamp
/// before 1970 or after 2262, a name of no or of more than 15 characters or with a blank in it.
constexpr std::string_view write_candump_line(const Frame& frame, std::string_view interface,
                                              StampDecimals decimals, CandumpText& text) noexcept {
    const std::int64_t seconds = frame.stamp_ns / 1'000'000'000;
    const std::int64_t nanoseconds = frame.stamp_ns % 1'000'000'000;
    if (!is_well_formed(frame) || frame.stamp_ns < 0 || seconds > detail::last_stamp_second ||
        interface.empty() || interface.size() > 15 ||
        interface.find_first_of(" \t\r\n") != std::string_view::npos) {
        return {};
    }
    const bool microseconds = decimals == StampDecimals::microseconds;
    detail::CandumpWriter out(text);
    out.put('(');
    out.decimal(seconds, 10);
    out.put('.');
    out.decimal(microseconds ? nanoseconds / 1000 : nanoseconds, microseconds ? 6 : 9);
    out.put(") ");
    out.put(interface);
    out.put(' ');
    out.hex(frame.error ? frame.id | detail::candump_error_flag : frame.id,
            frame.error || frame.extended ? 8 : 3);
    out.put('#');
    detail::write_payload(frame, out);
    if (frame.origin != Origin::remote) {
        out.put(" T");
    }
    return out.written();
}

} // namespace dfdyn::hal
