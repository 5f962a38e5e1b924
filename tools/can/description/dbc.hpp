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

/// Raw values of a multiplexor, ends included.
struct DbcValueRange {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
};

struct DbcSignal {
    std::string name;
    hal::Signal signal;
    double lowest = 0, highest = 0; ///< [0|0]: no limits are given
    std::string unit;
    bool multiplexor = false;               ///< `M`, `mNM`: its raw value says which of the others are there
    std::optional<std::uint64_t> multiplex; ///< `mN`: it is there where the multiplexor's raw value is N
    std::string multiplexed_by;             ///< SG_MUL_VAL_: the multiplexor's name; else empty
    std::vector<DbcValueRange> multiplex_ranges; ///< SG_MUL_VAL_: it is there at these values, not at N
};

struct DbcMessage {
    std::uint32_t id = 0;
    bool extended = false; ///< 29 bits
    std::string name;
    int length = 0; ///< bytes
    std::vector<DbcSignal> signals;

    /// Null where there is none of that name.
    const DbcSignal* find(std::string_view signal) const;
    /// The multiplexor of a multiplexed signal of this message: the one that SG_MUL_VAL_ names, else the only
    /// one of the message. Null where there is none, or where it is not known which of several it is.
    const DbcSignal* multiplexor_of(const DbcSignal& signal) const;
};

/// The messages of a DBC file: BO_, SG_ (both byte orders, signs, M, mN and mNM), SIG_VALTYPE_, SG_MUL_VAL_
/// (extended multiplexing). The rest is not looked at.
struct Dbc {
    std::vector<DbcMessage> messages;

    const DbcMessage* find(std::string_view message) const;
};

/// Throws InputError `SOURCE:LINE:COLUMN: expected …, found …` for what is malformed, a signal that does not
/// fit its message, a message or signal that is there twice, and a text in quotes without an end.
Dbc parse_dbc(std::string_view text, const std::string& source);
Dbc read_dbc(const std::filesystem::path& path);

} // namespace dfdyn::tools
