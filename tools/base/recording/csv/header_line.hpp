// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Splits the line with the names of the columns. Throws InputError, starting with `where` (file and line),
/// for bytes that are no text (UTF-16, CR line ends), a line of a candump log, or a line without a separator.
std::vector<std::string> header_names(std::string_view line, char separator, const std::string& where);

/// Returns ` (--columns q=q*,tau=tau*)`, which reads numbered columns that begin with 0, for the quantities
/// that have such columns. A pattern that also matches other columns is a list instead.
std::string from_zero(const std::vector<std::string>& columns);

} // namespace dfdyn::tools
