// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/error.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace dfdyn::tools {

/// `text` in double quotes for a message: its first 40 bytes (then `...`), bytes outside printable ASCII as
/// \xNN. Safe on a terminal whatever the bytes are.
std::string in_quotes(std::string_view text);

/// `path` for a message: as it is, but control characters as \xNN, so that the message stays one line.
std::string shown(const std::filesystem::path& path);

/// `names` for a message: separated by `, `, each as in_quotes shows it but for the quotes; `... (N in all)`
/// after the first 30.
std::string listed(std::span<const std::string> names);

/// `text` without the spaces and tabs at its ends. A view into `text`.
std::string_view trimmed(std::string_view text) noexcept;

/// The error `PATH: CANNOT: REASON`, with the system's words for `error_number` (an `errno` value).
InputError system_error(const std::filesystem::path& path, std::string_view cannot, int error_number);

} // namespace dfdyn::tools
