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

struct DbcSignal {
    std::string name;
    hal::Signal signal;
    double lowest = 0, highest = 0; ///< [0|0]: no limits are given
    std::string unit;
    bool multiplexor = false;               ///< `M`: its raw value says which of the others are there
    std::optional<std::uint64_t> multiplex; ///< `mN`: it is there where the multiplexor's raw value is N
};

struct DbcMessage {
    std::uint32_t id = 0;
    bool extended = false; ///< 29 bits
    std::string name;
    int length = 0; ///< bytes
    std::vector<DbcSignal> signals;

    /// Null where there is none of that name.
    const DbcSignal* find(std::string_view signal) const;
    const DbcSignal* multiplexor() const;
};

/// The messages of a DBC file: BO_, SG_ (both byte orders, signs, M and mN), SIG_VALTYPE_. The rest is not
/// looked at.
struct Dbc {
    std::vector<DbcMessage> messages;

    const DbcMessage* find(std::string_view message) const;
};

/// Throws InputError `SOURCE:LINE:COLUMN: expected …, found …` for what is malformed, a signal that does not
/// fit its message, a message or signal that is there twice, and extended multiplexing (mNM).
Dbc parse_dbc(std::string_view text, const std::string& source);
Dbc read_dbc(const std::filesystem::path& path);

} // namespace dfdyn::tools
