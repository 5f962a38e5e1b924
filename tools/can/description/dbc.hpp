// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Range of raw values of a multiplexor, including both ends.
struct DbcValueRange {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
};

struct DbcSignal {
    std::string name;
    hal::Signal signal;
    double lowest = 0, highest = 0; ///< [0|0]: no limits
    std::string unit;
    bool multiplexor = false; ///< `M`, `mNM`: its raw value selects which of the other signals are present
    std::optional<std::uint64_t> multiplex;      ///< `mN`: present if the multiplexor's raw value is N
    std::string multiplexed_by;                  ///< SG_MUL_VAL_: name of the multiplexor; otherwise empty
    std::vector<DbcValueRange> multiplex_ranges; ///< SG_MUL_VAL_: present at these values instead of N
};

struct DbcMessage {
    std::uint32_t id = 0;
    bool extended = false; ///< 29-bit identifier
    std::string name;
    int length = 0; ///< bytes
    std::vector<DbcSignal> signals;

    /// Returns the signal with this name; null if there is none.
    const DbcSignal* find(std::string_view signal) const;
    /// Returns the multiplexor of a multiplexed signal in this message: the one named by SG_MUL_VAL_,
    /// otherwise the only one in the message. Returns null if there is none, or if it is ambiguous.
    const DbcSignal* multiplexor_of(const DbcSignal& signal) const;
};

/// Messages of a DBC file: BO_, SG_ (both byte orders, signs, M, mN and mNM), SIG_VALTYPE_ and SG_MUL_VAL_
/// (extended multiplexing). Other statements are ignored.
struct Dbc {
    std::vector<DbcMessage> messages;

    const DbcMessage* find(std::string_view message) const;
};

/// Throws InputError `SOURCE:LINE:COLUMN: expected …, found …` for a syntax error, a signal that does not fit
/// its message, a duplicate message or signal, and an unterminated string.
Dbc parse_dbc(std::string_view text, const std::string& source);
Dbc read_dbc(const std::filesystem::path& path);

} // namespace dfdyn::tools
