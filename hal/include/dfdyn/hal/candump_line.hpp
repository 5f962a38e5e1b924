// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace dfdyn::hal {

/// Kind of a syntax error in a line; `expected` returns it as text.
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

/// Returns a description of the text that was expected at the error.
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

/// Result of reading one line of a candump log.
struct CandumpLine {
    /// Content of a line.
    enum class Kind : std::uint8_t {
        nothing,  ///< an empty line, or a comment that starts with #
        frame,    ///< `frame`
        dropped,  ///< `dropped` frames were lost at this line
        malformed ///< `fault`, at `column`
    };
    Kind kind = Kind::nothing;     ///< which of the other members are valid
    Frame frame{};                 ///< its time stamp is the log's, in nanoseconds; `stamp_source` is `log`
    std::string_view interface {}; ///< a view into the line
    std::uint64_t dropped = 0;     ///< frames that the recorder lost
    CandumpFault fault = CandumpFault::none; ///< the syntax error
    std::size_t column = 0;                  ///< position of the syntax error, counted from 1
    std::string_view found{}; ///< the text at `column` up to the next blank; empty at the end of the line
};

namespace detail {

inline constexpr std::uint32_t candump_error_flag = 0x20000000;
inline constexpr std::int64_t last_stamp_second = 9'223'372'035;

} // namespace detail

} // namespace dfdyn::hal
