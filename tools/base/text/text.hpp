// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/error.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace dfdyn::tools {

/// Returns `text` in double quotes for a message: its first 40 bytes (then `...`), with bytes outside
/// printable ASCII as \xNN. Any bytes are safe on a terminal.
std::string in_quotes(std::string_view text);

/// Returns `path` for a message, with control characters as \xNN, so that the message stays on one line.
std::string shown(const std::filesystem::path& path);

/// Returns `text` as one word of a POSIX shell: in single quotes unless it has only letters, digits and
/// `_-./+,:@%=`.
std::string shell_word(std::string_view text);

/// Returns `names` for a message: separated by `, `, each as in in_quotes but without quotes; `... (N in
/// all)` after the first 30.
std::string listed(std::span<const std::string> names);

/// Returns indices, such as of joints, for a message: counted from 1, separated by `, `.
std::string counted_from_one(std::span<const std::size_t> indices);

/// Returns a view of `text` without the spaces and tabs at its ends.
std::string_view trimmed(std::string_view text) noexcept;

/// Returns the error `PATH: CANNOT: REASON`, with the system's text for `error_number` (an `errno` value).
InputError system_error(const std::filesystem::path& path, std::string_view cannot, int error_number);

} // namespace dfdyn::tools
