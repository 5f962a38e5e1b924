// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/candump_line.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace dfdyn::hal {

/// Resolution of the time stamps in a log.
enum class StampDecimals : std::uint8_t {
    microseconds = 6, ///< readable by every tool; the nanoseconds are truncated
    nanoseconds = 9   ///< like `candump -N`; can-utils before 2023 misread it
};

/// Buffer that is large enough for any line.
using CandumpText = std::array<char, 192>;

namespace detail {

/// Appends characters to a CandumpText, which has room for the longest possible line.
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

/// Writes `frame` into `text` in the format of candump, without the line end. Frames of this host are marked
/// by ` T`, others have no mark. Returns an empty view for a frame that a log cannot represent:
/// - it is not well-formed,
/// - its time stamp is before 1970 or after 2262, or
/// - the interface name is empty, longer than 15 characters or contains a blank.
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
