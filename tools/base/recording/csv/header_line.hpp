// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Splits the line with the names of the columns. Throws InputError, starting with `where` (file and line),
/// if it is no text, as with UTF-16 or CR line ends, if it is a line of a candump log, or if it has no
/// separator.
std::vector<std::string> header_names(std::string_view line, char separator, const std::string& where);

/// Returns ` (--columns q=q*,tau=tau*)`, which reads numbered columns that begin with 0, for the quantities
/// that have such columns. A pattern that also matches other columns is a list instead.
std::string from_zero(const std::vector<std::string>& columns);

} // namespace dfdyn::tools
